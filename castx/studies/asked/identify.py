"""The table `[identify]`: measured curves, and the numbers of the case that they shall tell."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

from pydantic import Field

from castx.input.entries import Choice, Quantity, Whole
from castx.input.problems import Problem, among
from castx.input.units import TIME
from castx.studies.asked.candidates import CandidateSensor
from castx.studies.asked.curves import SensorCurve
from castx.studies.asked.runner import Running
from castx.studies.asked.unknowns import SoughtNumber

CLOCK = "clock"
LEVENBERG, ENSEMBLE = "levenberg-marquardt", "ensemble"


class Identify(Running):
    """A study that identifies numbers of the case.

    Attributes:
        curves: what was measured.
        unknowns: what is identified.
        clock_deviation: how well the time of the logger is known beside that of the run [s]; None:
            it is.
        engine: "levenberg-marquardt", by slopes; "ensemble", by the spread of many runs.
        tries: steps at most of the first one, refused ones too.
        members: of an ensemble.
        rounds: in which an ensemble takes the samples in.
        seed: of an ensemble.
        candidates: places for the next sensor.
        sensors: how many of them are chosen.
        every: time between their samples [s].
        wanted: unknowns that the A-optimal choice is for; none: all.
    """

    curves: tuple[SensorCurve, ...] = Field((), max_length=200)
    unknowns: tuple[SoughtNumber, ...] = Field((), max_length=100)
    clock_deviation: Annotated[float | None, Quantity(TIME, above=0.0)] = None
    engine: Annotated[str, Choice((LEVENBERG, ENSEMBLE))] = LEVENBERG
    tries: Annotated[int, Whole(1, 1000)] = 30
    members: Annotated[int, Whole(8, 10_000)] = 32
    rounds: Annotated[int, Whole(1, 100)] = 4
    seed: Annotated[int, Whole(0, 2**31 - 1)] = 0
    candidates: tuple[CandidateSensor, ...] = Field((), max_length=1000)
    sensors: Annotated[int, Whole(1, 100)] = 3
    every: Annotated[float, Quantity(TIME, above=0.0)] = 1.0
    wanted: tuple[str, ...] = Field((), max_length=100)

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield curves and unknowns that are missing or there twice."""
        for key in ("curves", "unknowns"):
            if not getattr(self, key) and not (key == "curves" and self.candidates):
                yield Problem((key,), f"missing; at least one [[identify.{key}]] is needed")
        places = [one.name for one in self.candidates]
        for index, name in enumerate(places):
            if name in places[:index]:
                yield Problem(("candidates", index, "name"), "is there already; choose another one")
        columns = [one.of for one in self.curves]
        for index, column in enumerate(columns):
            if column in columns[:index]:
                yield Problem(("curves", index, "of"), "is there already; leave one out")
        names = [one.name for one in self.unknowns]
        for index, name in enumerate(self.wanted):
            if name not in names:
                text = f"no unknown {name!r}; {among(name, names)}"
                yield Problem(("wanted", index), text)
        for index, one in enumerate(self.unknowns):
            if one.name in [other.name for other in self.unknowns[:index]] or one.name == CLOCK:
                yield Problem(("unknowns", index, "name"), "is there already; choose another one")
            if one.of in [other.of for other in self.unknowns[:index]]:
                yield Problem(("unknowns", index, "of"), "is identified already; leave one out")

    def relative_to(self, folder: Path) -> Identify:
        """Return the same with absolute paths of its files, given relative to a folder."""
        return self.model_copy(update={"curves": tuple(c.relative_to(folder) for c in self.curves)})
