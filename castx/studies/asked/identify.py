"""The table `[identify]`: measured curves, and the numbers of the case that they shall tell."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

from pydantic import Field

from castx.input.entries import Quantity, Whole
from castx.input.problems import Problem
from castx.input.units import TIME
from castx.studies.asked.curves import SensorCurve
from castx.studies.asked.runner import Running
from castx.studies.asked.unknowns import SoughtNumber

CLOCK = "clock"


class Identify(Running):
    """A study that identifies numbers of the case.

    Attributes:
        curves: what was measured.
        unknowns: what is identified.
        clock_deviation: how well the time of the logger is known beside that of the run [s]; None:
            it is.
        tries: steps at most, refused ones too.
    """

    curves: tuple[SensorCurve, ...] = Field((), max_length=200)
    unknowns: tuple[SoughtNumber, ...] = Field((), max_length=100)
    clock_deviation: Annotated[float | None, Quantity(TIME, above=0.0)] = None
    tries: Annotated[int, Whole(1, 1000)] = 30

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield curves and unknowns that are missing or there twice."""
        for key in ("curves", "unknowns"):
            if not getattr(self, key):
                yield Problem((key,), f"missing; at least one [[identify.{key}]] is needed")
        columns = [one.of for one in self.curves]
        for index, column in enumerate(columns):
            if column in columns[:index]:
                yield Problem(("curves", index, "of"), "is there already; leave one out")
        for index, one in enumerate(self.unknowns):
            if one.name in [other.name for other in self.unknowns[:index]] or one.name == CLOCK:
                yield Problem(("unknowns", index, "name"), "is there already; choose another one")
            if one.of in [other.of for other in self.unknowns[:index]]:
                yield Problem(("unknowns", index, "of"), "is identified already; leave one out")

    def relative_to(self, folder: Path) -> Identify:
        """Return the same with absolute paths of its files, given relative to a folder."""
        return self.model_copy(update={"curves": tuple(c.relative_to(folder) for c in self.curves)})
