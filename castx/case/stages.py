"""Stages of a process: changes at times of the run, and their schedule over all cycles."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import Field, PlainValidator

from castx.case.boundaries import Boundary
from castx.errors import CaseError
from castx.input.entries import Description, EntryName, Quantity, Whole
from castx.input.problems import Problem, Refusal
from castx.input.units import PURE_NUMBER, TEMPERATURE_DIFFERENCE, TIME
from castx.input.variation import Variation
from castx.tables import Table
from castx.transfer.conditions.convection import COEFFICIENT
from castx.transfer.conditions.keys import AMBIENT

SLACK = 1e-9
"""Relative difference below which two times are the same."""

_FRICTION = Quantity(PURE_NUMBER, least=0.0)
_MOST_CYCLES = 10_000
_MOST_NAMES = 100
_MOST_BOUNDARIES = 1000


def _friction(value: Any) -> dict[str, float] | float:
    """Return coefficients of friction by body, or one for all removed bodies."""
    if not isinstance(value, dict):
        try:
            return _FRICTION.read(value)
        except CaseError as error:
            text = "or one for each body: { core = 0.3 }"
            raise CaseError(f"a coefficient of friction is needed, {error}; {text}") from None
    if not value:
        raise CaseError("names no body; give coefficients of friction such as { core = 0.3 }")
    found = {}
    for name, coefficient in value.items():
        try:
            found[name] = _FRICTION.read(coefficient)
        except CaseError as error:
            raise Refusal([Problem((name,), str(error))]) from None
    return found


class Spray(Description):
    """A fluid that cools surfaces by convection, in place of their earlier heat conditions.

    Attributes:
        on: surfaces "body/surface", or bodies with all their surfaces but symmetry planes; by
            default the surfaces that removed bodies have left bare.
        coefficient: of convection over time or temperature, as of a surface [W/m²/K].
        ambient: temperature of the fluid over time [°C].
    """

    on: Annotated[tuple[str, ...], Field(max_length=_MOST_NAMES)] = ()
    coefficient: Annotated[Variation, COEFFICIENT.entry]
    ambient: Annotated[Table, AMBIENT.entry]


class Stage(Description):
    """Changes at a time of the cycle, which last until a later stage changes the same again.

    Attributes:
        at: time in the cycle [s].
        remove: bodies that are taken away.
        boundaries: conditions that replace those of the same kind on the same surface;
            `displacement = "free"` lifts a prescribed displacement.
        spray: a fluid that cools surfaces.
        eject: coefficient of friction from which the force to draw a body is estimated: one for
            all that the stage removes, or one by body.
        repeat: number of cycles, in the last stage.
        renew: bodies that each cycle starts with anew.
        periodic: estimated distance from the state to which the cycles tend, below which they are
            called periodic [K].
    """

    at: Annotated[float, Quantity(TIME, above=0.0)]
    remove: Annotated[tuple[EntryName, ...], Field(max_length=_MOST_NAMES)] = ()
    boundaries: Annotated[tuple[Boundary, ...], Field(max_length=_MOST_BOUNDARIES)] = ()
    spray: Spray | None = None
    eject: Annotated[dict[str, float] | float | None, PlainValidator(_friction)] = None
    repeat: Annotated[int | None, Whole(1, _MOST_CYCLES)] = None
    renew: Annotated[tuple[EntryName, ...], Field(max_length=_MOST_NAMES)] = ()
    periodic: Annotated[float, Quantity(TEMPERATURE_DIFFERENCE, above=0.0)] = 1.0

    @property
    def acts(self) -> bool:
        """Whether anything changes at its time except that a cycle ends."""
        asked = (self.spray, self.eject)
        return bool(self.remove or self.boundaries) or any(item is not None for item in asked)

    @property
    def friction(self) -> dict[str, float]:
        """Coefficients of friction by body."""
        if isinstance(self.eject, dict):
            return self.eject
        return {} if self.eject is None else dict.fromkeys(self.remove, self.eject)

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield an empty stage, names given twice, and keys that need `repeat`."""
        if not self.acts and self.repeat is None:
            yield Problem((), "says nothing; give remove, boundaries, spray, eject or repeat")
        for key in ("remove", "renew"):
            names = getattr(self, key)
            for index, name in enumerate(names):
                if name in names[:index]:
                    yield Problem((key, index), "is there already")
        for key in ("renew", "periodic"):
            if key in self.model_fields_set and self.repeat is None:
                yield Problem((key,), "belongs to cycles; give repeat, the number of them, too")
        if isinstance(self.eject, float) and not self.remove:
            text = "the stage removes no body to draw; name it in remove, or here: { core = 0.3 }"
            yield Problem(("eject",), text)


@dataclass(frozen=True)
class Phase:
    """One stage in one cycle.

    Attributes:
        start: time at which it begins [s].
        stage: its number; 0 is the start, before all stages.
        cycle: its number, from 1.
        cycle_start: time at which the cycle begins [s]; tables over time count from there.
    """

    start: float
    stage: int
    cycle: int
    cycle_start: float


class Schedule:
    """All phases of a run, in their order.

    Attributes:
        phases: the phases.
        stages: number of different stages, the start included.
        cycles: number of cycles.
        cycle_length: from cycle to cycle [s].
        end: of the run [s].

    The last stage may ask for cycles. One that does nothing else marks the end of the cycle; behind
    one that acts, the cycle ends at the end of the case.

    Args:
        stages: of the case.
        end: of the case [s]: of the run, or where cycles go on longer of the first one.
    """

    def __init__(self, stages: Sequence[Stage], end: float) -> None:
        self.cycles = (stages[-1].repeat or 1) if stages else 1
        self.cycle_length = end
        starts = [0.0, *(stage.at for stage in stages)]
        if stages and not stages[-1].acts:
            self.cycle_length = starts.pop()
        self.stages = len(starts)
        whole = self.cycles * self.cycle_length
        cut = self.cycle_length * (1 + SLACK) < end < whole
        self.end = end if cut else whole
        self.phases = [
            Phase(cycle * self.cycle_length + start, stage, cycle + 1, cycle * self.cycle_length)
            for cycle in range(self.cycles)
            for stage, start in enumerate(starts)
            if cycle * self.cycle_length + start < self.end * (1 - SLACK)
        ]

    @property
    def stops(self) -> tuple[float, ...]:
        """Times at which a phase ends and the next one begins [s]."""
        return tuple(phase.start for phase in self.phases[1:])

    def number_at(self, time: float) -> int:
        """Return the number of the phase of a step that begins at a time [s]."""
        starts = [phase.start for phase in self.phases]
        return bisect_right(starts, time + SLACK * self.end) - 1
