"""Conditions on the outer surfaces of the bodies, gravity, and supports of free bodies."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import Field, PlainValidator, ValidationInfo, field_validator

from castx.errors import CaseError
from castx.input.entries import Choice, Description, Quantity, over_time, with_entries
from castx.input.placed import Placed, PlacedOverTime, PlacedTable
from castx.input.problems import Problem, Refusal, among, refuse
from castx.input.units import (
    ACCELERATION,
    FORCE,
    LENGTH,
    STIFFNESS,
    STRESS,
)
from castx.tables import Table
from castx.transfer.conditions.declaration import HeatConditionKind
from castx.transfer.conditions.registry import heat_conditions, key_names
from castx.transfer.declaration import Given

DIRECTIONS = ("x", "y", "z", "r", "normal", "all")
LOADS = ("pressure", "traction", "clamp")
"""Conditions that press or pull on a surface."""
FRAME = "all"
"""Direction of a clamp that holds in all of them."""
CONDITIONS = ("heat", "displacement", *LOADS)
"""Kinds of conditions on a surface."""

_MOST_CONDITIONS = 20
_LOAD = PlacedOverTime(Quantity(STRESS))


def _heat_number(value: Any, info: ValidationInfo) -> Any:
    """Return the value of a key of a heat condition as its type reads it."""
    kind = heat_conditions().get(info.data.get("type", ""))
    key = kind.key(str(info.field_name)) if kind is not None else None
    return value if key is None else key.read(value)  # refused with the type, or as not used


@with_entries({name: (_heat_number, None) for name in key_names()})
class HeatCondition(Description):
    """Heat through a surface, with a number for each key of its type.

    Attributes:
        type: a name of `heat_conditions`, which say what numbers it has beside.
    """

    type: Annotated[str, Choice(tuple(heat_conditions()))]

    @property
    def declared(self) -> HeatConditionKind:
        """The declaration of the type."""
        return heat_conditions()[self.type]

    @property
    def given(self) -> Given:
        """The numbers that the case gives."""
        names = self.model_fields_set - {"type"}
        return Given({name: getattr(self, name) for name in names})

    @property
    def temperatures(self) -> list[Table | PlacedTable]:
        """The temperatures that it names, over time or place [°C]."""
        return self.declared.temperatures(self.given)

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield numbers that the type lacks or cannot use."""
        kind, given = self.declared, self.model_fields_set - {"type"}
        for key in key_names():
            if key in kind.needed and key not in given:
                yield Problem((key,), f"missing; heat of type {self.type!r} needs it")
            if key in given and kind.key(key) is None:
                used = ", ".join(own.name for own in kind.keys) or "no numbers"
                yield Problem((key,), f"heat of type {self.type!r} uses {used}")


@dataclass(frozen=True, eq=False)
class DisplacementCondition:
    """Prescribed displacement of a surface in one direction.

    Args:
        direction: one of `DIRECTIONS`, or "free": a stage lifts the earlier condition.
        value: metres over time, along the direction; None when uniform.
        uniform: all nodes of the surface move equally, with a free resultant.
    """

    direction: str
    value: Table | None
    uniform: bool


FREE = DisplacementCondition("free", None, uniform=False)


def _heat_conditions(value: Any) -> tuple[HeatCondition, ...]:
    if not isinstance(value, list | tuple):
        return (HeatCondition.read(value),)
    if not 1 <= len(value) <= _MOST_CONDITIONS:
        raise CaseError(f"a list of 1 to {_MOST_CONDITIONS} heat conditions is needed")
    conditions = []
    for index, entry in enumerate(value):
        try:
            conditions.append(HeatCondition.read(entry))
        except Refusal as error:
            raise error.inside(index) from None
    return tuple(conditions)


def _displacements(value: Any) -> tuple[DisplacementCondition, ...]:
    if isinstance(value, tuple):
        return value
    if value == FREE.direction:
        return (FREE,)
    if not isinstance(value, dict) or not value:
        raise CaseError("a table of directions is needed, such as { normal = 0 }")
    if "all" in value and len(value) > 1:
        raise refuse("leaves nothing for the other directions", "all")
    return tuple(_displacement(direction, entry) for direction, entry in value.items())


def _displacement(direction: str, value: Any) -> DisplacementCondition:
    if direction not in DIRECTIONS:
        raise refuse(f"unknown direction; {among(direction, DIRECTIONS)}", direction)
    if value == "uniform":
        return DisplacementCondition(direction, None, uniform=True)
    try:
        return DisplacementCondition(direction, over_time(LENGTH).read(value), uniform=False)
    except Refusal as error:
        raise error.inside(direction) from None
    except CaseError as error:
        raise refuse(f'{error}, or "uniform"', direction) from None


class ClampCondition(Description):
    """A machine that presses on a surface by a force and resists its motion by a stiffness.

    Both are totals: of the full turn when axisymmetric, of one metre of depth in plane models, and
    of the meshed part in space.

    Attributes:
        force: over time, where the surface was meshed [N].
        stiffness: of the machine behind the surface [N/m]; None: the force follows its motion.
        direction: axis along which it presses; None: against the normal of a flat surface; "all":
            it is a frame that holds in all directions, and presses in none.
    """

    force: Annotated[Table | None, over_time(FORCE, least=0.0)] = None
    stiffness: Annotated[float | None, Quantity(STIFFNESS, above=0.0)] = None
    direction: Annotated[str | None, Choice(("x", "y", "z", FRAME))] = None

    @property
    def is_frame(self) -> bool:
        """Whether it holds in all directions."""
        return self.direction == FRAME

    @property
    def released(self) -> ClampCondition:
        """Return the clamp without force and stiffness, which still records its motion."""
        return self.model_copy(update={"force": Table.constant(0.0), "stiffness": None})

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield a clamp without force and stiffness."""
        if self.force is None and self.stiffness is None:
            yield Problem((), "says nothing; give force, stiffness or both")
        if self.is_frame and self.force is not None:
            text = 'a force has one direction: leave it out beside direction = "all"'
            yield Problem(("force",), text)


FREE_CLAMP = ClampCondition(force=Table.constant(0.0))
"""What `clamp = "free"` means: a stage lifts the earlier clamp."""


def _clamp(value: Any) -> ClampCondition:
    if isinstance(value, ClampCondition):
        return value
    return FREE_CLAMP if value == FREE.direction else ClampCondition.read(value)


class Boundary(Description):
    """Conditions on one named surface.

    Attributes:
        on: the surface as "body/surface".
        heat: heat conditions, which add up.
        displacement: prescribed displacements by direction.
        pressure: pressing on the surface, over time and place [Pa].
        traction: force per area over time and place, one for each direction of the model [Pa].
        clamp: a machine that presses on the surface.
    """

    on: str
    heat: Annotated[tuple[HeatCondition, ...], PlainValidator(_heat_conditions)] = ()
    displacement: Annotated[tuple[DisplacementCondition, ...], PlainValidator(_displacements)] = ()
    pressure: Annotated[Table | Placed | None, _LOAD] = None
    traction: (
        Annotated[tuple[Annotated[Table | Placed, _LOAD], ...], Field(max_length=3)] | None
    ) = None
    clamp: Annotated[ClampCondition | None, PlainValidator(_clamp)] = None

    @field_validator("on", mode="plain")
    @classmethod
    def _read_on(cls, value: Any) -> str:
        if not isinstance(value, str) or len(value) > 200 or not all(value.partition("/")):
            raise CaseError('a surface is named "body/surface"')
        return value

    @property
    def body(self) -> str:
        """Name of the body that owns the surface."""
        return self.on.partition("/")[0]

    @property
    def surface(self) -> str:
        """Name of the surface on its body."""
        return self.on.partition("/")[2]

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield heat conditions that exclude each other, and a boundary without any condition."""
        alone = sorted({heat.type for heat in self.heat if heat.declared.flux is None})
        for name in alone if len(self.heat) > 1 else ():
            yield Problem(("heat",), f"type {name!r} excludes every other heat condition")
        if not any(getattr(self, kind) for kind in CONDITIONS):
            yield Problem((), f"says nothing; give {', '.join(CONDITIONS[:-1])} or clamp")


class Loads(Description):
    """Forces on all bodies.

    Attributes:
        gravity: acceleration [m/s²]; after loading one number for each direction of the model.
    """

    gravity: Annotated[
        tuple[Annotated[float, Quantity(ACCELERATION)], ...], Field(max_length=3)
    ] = ()


def surface_names(value: Any) -> tuple[str, ...]:
    """Return the surfaces "body/surface" of an entry.

    Raises:
        CaseError: it is no list of them, or one stands twice.
    """
    if not isinstance(value, list | tuple) or len(value) > _MOST_CONDITIONS:
        raise CaseError('a list of surfaces "body/surface" is needed')
    for index, name in enumerate(value):
        if not isinstance(name, str) or len(name) > 200 or not all(name.partition("/")):
            raise refuse('a surface is named "body/surface"', index)
        if name in value[:index]:
            raise refuse("is there already", index)
    return tuple(value)


class Support(Description):
    """Supports of bodies that no condition and no contact constrain.

    Attributes:
        mode: whether springs are added automatically.
        in_gate: surfaces "body/surface" that are fixed only while their body has no contact.
    """

    mode: Annotated[str, Choice(("automatic", "none"))] = "automatic"
    in_gate: Annotated[tuple[str, ...], PlainValidator(surface_names)] = ()

    def by_body(self) -> dict[str, list[str]]:
        """Return the names of the in-gate surfaces by body."""
        found: dict[str, list[str]] = {}
        for place in self.in_gate:
            body, _, surface = place.partition("/")
            found.setdefault(body, []).append(surface)
        return found
