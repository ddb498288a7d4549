"""Descriptions of the stages of a process: what changes at a time of the run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import Field, PlainValidator

from castx.case.boundaries import COEFFICIENT, Boundary
from castx.errors import CaseError
from castx.input.entries import Description, EntryName, Quantity, Whole, over_time
from castx.input.problems import Problem, Refusal
from castx.input.units import PURE_NUMBER, TEMPERATURE, TEMPERATURE_DIFFERENCE, TIME
from castx.input.variation import Variation
from castx.tables import Table

_FRICTION = Quantity(PURE_NUMBER, least=0.0)
_MOST_CYCLES = 10_000
_MOST_NAMES = 100
_MOST_BOUNDARIES = 1000


def _friction(value: Any) -> dict[str, float] | float:
    """Return the coefficients of friction of bodies by name, or that of all removed ones."""
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
    """A fluid that cools surfaces instead of what cooled them before, by convection.

    `on` names surfaces "body/surface", or bodies with all their surfaces but symmetry planes; by
    default all that removed bodies have left bare. `coefficient` [W/m²/K] over time or temperature
    and `ambient` [°C] are those of `HeatCondition`.
    """

    on: Annotated[tuple[str, ...], Field(max_length=_MOST_NAMES)] = ()
    coefficient: Annotated[Variation, COEFFICIENT]
    ambient: Annotated[Table, over_time(TEMPERATURE)]


class Stage(Description):
    """What changes `at` a time [s] of the cycle, and lasts until a later stage changes it again.

    `remove` takes bodies away; `boundaries` replace the conditions of the same kind on the same
    surface, `displacement = "free"` lifts what held it; `eject` gives the coefficient of friction
    from which the force to draw a body is estimated: one for all that the stage removes, or one for
    each name. In the last stage, `repeat` is the number of cycles, `renew` the bodies that each of
    them starts with anew, and `periodic` [K] the distance from the state to which the cycles tend,
    estimated from how they change, below which they are called periodic.
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
        """Whether anything changes at its time, other than that a cycle ends."""
        asked = (self.spray, self.eject)
        return bool(self.remove or self.boundaries) or any(item is not None for item in asked)

    @property
    def friction(self) -> dict[str, float]:
        """Coefficients of friction by body."""
        if isinstance(self.eject, dict):
            return self.eject
        return {} if self.eject is None else dict.fromkeys(self.remove, self.eject)

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield a stage that says nothing, names given twice, and keys that need `repeat`."""
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
