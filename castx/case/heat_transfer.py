"""The heat transfer between facing surfaces, by a law or by several on its parts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
from pydantic import Field, GetJsonSchemaHandler, PlainValidator, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from castx.arrays import BoolArray, FloatArray
from castx.errors import CaseError
from castx.input.coordinates import AXES, coordinate
from castx.input.entries import Choice, Description, Quantity
from castx.input.problems import Problem, Refusal, among, refuse
from castx.input.units import LENGTH
from castx.input.variation import Variation
from castx.transfer import keys
from castx.transfer.conductance import ConductionLaw
from castx.transfer.declaration import GapHeatLaw, Given
from castx.transfer.naming import FROM, changed, with_entry
from castx.transfer.registry import gap_heat_laws, with_keys_of_laws
from castx.transfer.surfaces import Coating, ContactConductance, CurvedGap, Radiation, Roughness

_MOST_PATCHES = 100
_NO_NUMBERS = frozenset({"entry", "law", "patches"})
"""Keys that say which law acts where, and where its numbers come from."""


@dataclass(frozen=True)
class Patch:
    """A part of an interface, and the keys that are different there.

    Args:
        within: bounds of the part, inclusive, by coordinate [m].
        changes: keys of the heat transfer with their values, as written.
        on: name that the mesh has for the faces of the part; "": any.
    """

    within: Mapping[str, tuple[float, float]]
    changes: Mapping[str, Any]
    on: str = ""

    def contains(
        self, points: npt.ArrayLike, marked: Mapping[str, FloatArray]
    ) -> BoolArray:
        """Return a mask of the points in the part, shape (n,).

        Args:
            points: of the interface, shape (n, gdim) [m].
            marked: points of the faces that the mesh names between bodies, by name [m].
        """
        inside = np.ones(len(np.asarray(points)), dtype=bool)
        if self.on:
            named = {tuple(point) for point in marked[self.on]}
            inside &= np.array([tuple(point) in named for point in np.asarray(points)], dtype=bool)
        for axis, (low, high) in self.within.items():
            place = coordinate(points, axis)
            inside &= (place >= low) & (place <= high)
        return inside


def _patches(value: Any) -> tuple[Patch, ...]:
    if not isinstance(value, list | tuple) or not 1 <= len(value) <= _MOST_PATCHES:
        raise CaseError(f"a list of 1 to {_MOST_PATCHES} patches is needed")
    return tuple(_patch(index, entry) for index, entry in enumerate(value))


def _patch(index: int, entry: Any) -> Patch:
    if isinstance(entry, Patch):
        return entry
    if not isinstance(entry, dict) or not ("within" in entry or "on" in entry):
        places = '{ within = { z = [0, 1] }, ... } or { on = "NAME", ... }'
        raise refuse(f"a table with a place is needed: {places}", index)
    within, on = entry.get("within", {}), entry.get("on", "")
    if not isinstance(within, dict) or not (within or "within" not in entry):
        raise refuse(f"needs a coordinate: {', '.join(AXES)}", index, "within")
    if not isinstance(on, str) or not (on or "on" not in entry):
        raise refuse("a name that the mesh has for faces between the bodies is needed", index, "on")
    changes = {key: item for key, item in entry.items() if key not in ("within", "on")}
    if not changes or "patches" in changes:
        raise refuse("must say what is different there: closed, coating, ...", index)
    try:
        changes = with_entry(changes)
    except Refusal as error:
        raise error.inside(index) from None
    return Patch({a: _bounds(index, a, b) for a, b in within.items()}, changes, on)


def _bounds(index: int, axis: str, value: Any) -> tuple[float, float]:
    if axis not in AXES:
        raise refuse(f"unknown coordinate; {among(axis, AXES)}", index, "within", axis)
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise refuse("two bounds are needed: [low, high]", index, "within", axis)
    try:
        low, high = (Quantity(LENGTH).read(bound) for bound in value)
    except CaseError as error:
        raise refuse(str(error), index, "within", axis) from None
    if low > high:
        raise refuse("the lower bound comes first", index, "within", axis)
    return low, high


@with_keys_of_laws
class InterfaceHeat(Description):
    """Heat transfer between the facing surfaces, q = h (T_secondary − T_primary) + radiation.

    Laws may have further keys of their own.

    Attributes:
        entry: interface of the database, `from` in a case file, whose keys those beside it change.
        law: name of the gap heat law.
        closed: coefficient of touching surfaces without pressure [W/m²/K]; left out, it is 1/R of
            roughness and coating.
        open: coefficient of the open gap [W/m²/K].
        gas_conductivity: of the gas in gap and roughness [W/m/K].
        transition: width of gaps over which the bend of the law is rounded [m].
        pressure: conductance that contact pressure adds.
        roughness: of the surfaces, a resistance of the gas in it.
        coating: between the surfaces, a resistance.
        radiation: across the gap.
        curved: a wide gap between cylinders or spheres.
        patches: parts of the interface with other keys; the first that contains a pair counts.
    """

    entry: Annotated[str, Field(alias=FROM)] = ""
    law: Annotated[str, Choice(tuple(gap_heat_laws()))]
    closed: Annotated[Variation | None, keys.CLOSED.entry] = None
    open: Annotated[Variation | None, keys.OPEN.entry] = None
    gas_conductivity: Annotated[Variation | None, keys.GAS_CONDUCTIVITY.entry] = None
    transition: Annotated[float, keys.TRANSITION.entry] = 0.0
    pressure: ContactConductance | None = None
    roughness: Roughness | None = None
    coating: Coating | None = None
    radiation: Radiation | None = None
    curved: CurvedGap | None = None
    patches: Annotated[tuple[Patch, ...], PlainValidator(_patches)] = ()

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Return the schema of the file, in which an entry of the database may give the law."""
        schema = handler.resolve_ref_schema(handler(core))
        schema.pop("required", None)
        return schema

    @model_validator(mode="before")
    @classmethod
    def _with_entry(cls, data: Any) -> Any:
        return with_entry(data) if isinstance(data, Mapping) else data

    @property
    def declared(self) -> GapHeatLaw:
        """The declaration of the law."""
        return gap_heat_laws()[self.law]

    @property
    def given(self) -> Given:
        """The keys of the law that the case gives."""
        names = self.model_fields_set - _NO_NUMBERS
        return Given({name: getattr(self, name) for name in names})

    @property
    def rough(self) -> bool:
        """Whether roughness or coating give a resistance."""
        return self.roughness is not None or self.coating is not None

    @property
    def parts(self) -> list[InterfaceHeat]:
        """The heat transfer of the interface, then of its patches."""
        return [self, *(self.on(patch) for patch in self.patches)]

    def conduction_law(self) -> ConductionLaw:
        """Return the law of heat conduction outside the patches, not for perfect contact."""
        build = self.declared.build
        assert build is not None
        return build(self.given)

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield keys that the law needs or does not use."""
        found = [*self._key_problems(), *self._roughness_problems(), *self._variation_problems()]
        yield from found
        if not found:
            yield from self.declared.problems(self.given)
            yield from self._patch_problems()

    def _key_problems(self) -> Iterator[Problem]:
        law, given = self.declared, self.given
        needed = {key.name for key in law.needed}
        usable = [key.name for key in law.keys]
        replaced = {other.name for key, others in law.instead.items() if given.has(key)
                    for other in others} | ({"closed"} if self.rough else set())  # fmt: skip
        for key in type(self).model_fields:
            if key in needed - replaced and key not in self.model_fields_set:
                yield Problem((key,), f"missing; the law {self.law!r} needs it")
            if key in self.model_fields_set and key not in {*usable, *_NO_NUMBERS}:
                used = ", ".join(usable) or "no further numbers"
                yield Problem((key,), f"the law {self.law!r} takes {used}")
        if law.exchange == "perfect" and self.patches:
            yield Problem(("patches",), "perfect contact has no parts")
        yield from self._doubled_keys(law)

    def _doubled_keys(self, law: GapHeatLaw) -> Iterator[Problem]:
        """Yield keys that another one replaces, but for the gas that the roughness needs."""
        for key, others in law.instead.items():
            for other in others if self.given.has(key) else ():
                used = other is keys.GAS_CONDUCTIVITY and self.rough
                if other.name in self.model_fields_set and not used:
                    text = f"{key.name} is given already; leave one of them out"
                    yield Problem((other.name,), text)

    def _roughness_problems(self) -> Iterator[Problem]:
        pressure = self.pressure
        lacks = pressure is not None and pressure.resistance is None and not pressure.rough
        if lacks and not self.rough:
            text = "missing; give it, or roughness and coating"
            yield Problem(("pressure", "resistance"), text)
        for key in keys.ROUGH:
            if self.given.has(key) and self.closed is not None and not lacks:
                text = "not used: closed is given, and no pressure term needs it; leave one out"
                yield Problem((key.name,), text)
        depths = [self.roughness, None if pressure is None else pressure.roughness]
        if any(depths) and self.gas_conductivity is None:
            yield Problem(("gas_conductivity",), "missing; the gas in the roughness needs it")

    def _variation_problems(self) -> Iterator[Problem]:
        for key in self.declared.keys:
            variation = self.given.get(key)
            if not key.over or not isinstance(variation, Variation):
                continue
            constant = variation.is_constant and "time" in key.over
            if variation.over not in key.over and not constant:
                text = f"in the law {self.law!r} it varies over {' or '.join(key.over)}"
                yield Problem((key.name,), f'{text}: {{ over = "{key.over[0]}", table = ... }}')

    def _patch_problems(self) -> Iterator[Problem]:
        for index, patch in enumerate(self.patches):
            try:
                heat = self.on(patch)
            except Refusal as error:
                yield from error.inside("patches", index).problems
                continue
            if heat.declared.exchange == "perfect":
                text = "perfect contact has no parts; give a large closed"
                yield Problem(("patches", index, "law"), text)

    def on(self, patch: Patch) -> InterfaceHeat:
        """Return the heat transfer on a patch: the keys of the interface, changed by its own.

        A patch with a law or an entry of its own takes over nothing but the radiation.

        Raises:
            Refusal: the keys are inconsistent.
        """
        kept = {"radiation"} if "law" in patch.changes else set(type(self).model_fields)
        kept = (kept & self.model_fields_set) - {"entry", "patches"}
        return InterfaceHeat.read(changed({key: getattr(self, key) for key in kept}, patch.changes))
