"""Description of the heat transfer between facing surfaces; no dolfinx."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
from pydantic import Field, PlainValidator

from castx.arrays import BoolArray, FloatArray
from castx.errors import CaseError
from castx.input.coordinates import AXES, coordinate
from castx.input.entries import Choice, Description, Quantity
from castx.input.problems import Problem, Refusal, among, refuse
from castx.input.units import (
    CONDUCTIVITY,
    HEAT_TRANSFER,
    LENGTH,
    PURE_NUMBER,
    STRESS,
    THERMAL_RESISTANCE,
)
from castx.input.variation import Variation, Varying

_FACES = ("secondary", "primary", "mean")
_MOST_PATCHES = 100
_ROUGH = ("roughness", "coating")

# What each law needs, and what it can use besides.
_KEYS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "limited": (
        ("closed", "gas_conductivity"),
        ("open", "pressure", "transition", *_ROUGH, "radiation"),
    ),
    "series": (("closed", "gas_conductivity"), ("pressure", "transition", *_ROUGH, "radiation")),
    "constant": (("closed",), ("pressure", "gas_conductivity", *_ROUGH, "radiation")),
    "solid-fraction": (("closed", "open"), ("gas_conductivity", *_ROUGH, "radiation")),
    "perfect": ((), ()),
    "none": ((), ("radiation",)),
}
# Over which quantities the coefficients of a law may vary.
_OVER: dict[tuple[str, str], tuple[str, ...]] = {
    ("limited", "closed"): ("temperature", "time", "pressure"),
    ("series", "closed"): ("temperature", "time", "pressure"),
    ("limited", "open"): ("gap",),
    ("solid-fraction", "closed"): ("temperature", "time"),
    ("solid-fraction", "open"): ("temperature", "time"),
}
_COEFFICIENT = Varying(
    Quantity(HEAT_TRANSFER, above=0.0), ("temperature", "time", "gap", "pressure"), _FACES
)
_GAS = Varying(
    Quantity(CONDUCTIVITY, above=0.0), ("temperature", "time"), ("mean", "secondary", "primary")
)
_DEPTH = Annotated[float, Quantity(LENGTH, least=0.0)]
_Roughness = Annotated[tuple[_DEPTH, ...], Field(min_length=2, max_length=2)]


class Coating(Description):
    """A layer on the mould: thickness δ [m] and conductivity k [W/m/K], of resistance δ/k."""

    thickness: Annotated[float, Quantity(LENGTH, above=0.0)]
    conductivity: Annotated[float, Quantity(CONDUCTIVITY, above=0.0)]

    @property
    def resistance(self) -> float:
        """δ/k [m² K/W]."""
        return self.thickness / self.conductivity


class ContactConductance(Description):
    """Heat transfer that contact pressure adds, (1/R)(p/H_e)^b: R [m²K/W], H_e [Pa], b.

    R is given, or follows from the roughness of both sides and a coating, here or beside the law.
    """

    resistance: Annotated[float | None, Quantity(THERMAL_RESISTANCE, above=0.0)] = None
    hardness: Annotated[float, Quantity(STRESS, above=0.0)]
    exponent: Annotated[float, Quantity(PURE_NUMBER, above=0.0, most=5.0)] = 0.95
    roughness: _Roughness | None = None
    coating: Coating | None = None

    @property
    def rough(self) -> bool:
        """Whether the roughness or coating of its own gives R."""
        return self.roughness is not None or self.coating is not None

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield two ways of giving R."""
        for key in _ROUGH:
            if self.resistance is not None and getattr(self, key) is not None:
                yield Problem((key,), "resistance is given already; leave one of them out")


class Radiation(Description):
    """Radiation across the gap; emissivities in the order of the bodies."""

    emissivities: Annotated[
        tuple[Annotated[float, Quantity(PURE_NUMBER, above=0.0, most=1.0)], ...],
        Field(min_length=2, max_length=2),
    ]


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

    def holds(
        self, points: npt.ArrayLike, marked: Mapping[str, FloatArray]
    ) -> BoolArray:
        """Return which points (n, gdim) lie in the part.

        Args:
            points: of the interface [m].
            marked: points of the faces between bodies by the name the mesh has for them.
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


class InterfaceHeat(Description):
    """Heat transfer between the facing surfaces, q = h (T_secondary − T_primary) + radiation.

    `closed` [W/m²/K] is the coefficient of touching surfaces without pressure; left out, it is 1/R
    of roughness and coating. `gas_conductivity` [W/m/K] is that of the gas in gap and roughness,
    `open` [W/m²/K] the coefficient of the open gap, `pressure` adds to closed contact, `transition`
    [m] is the width of gaps over which the bend of the law is rounded. `patches` are parts of the
    interface where keys differ; the first that holds a pair counts.
    """

    law: Annotated[str, Choice(tuple(_KEYS))]
    closed: Annotated[Variation | None, _COEFFICIENT] = None
    open: Annotated[Variation | None, _COEFFICIENT] = None
    gas_conductivity: Annotated[Variation | None, _GAS] = None
    transition: Annotated[float, Quantity(LENGTH, above=0.0)] = 0.0
    pressure: ContactConductance | None = None
    roughness: _Roughness | None = None
    coating: Coating | None = None
    radiation: Radiation | None = None
    patches: Annotated[tuple[Patch, ...], PlainValidator(_patches)] = ()

    @property
    def rough(self) -> bool:
        """Whether roughness or coating give a resistance."""
        return self.roughness is not None or self.coating is not None

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield what the law lacks or cannot use."""
        found = [*self._key_problems(), *self._roughness_problems(), *self._variation_problems()]
        yield from found
        if not found:
            yield from self._closure_problems()
            yield from self._patch_problems()

    def _key_problems(self) -> Iterator[Problem]:
        needed, useful = _KEYS[self.law]
        usable = (*needed, *useful)
        tabulated = self.law == "limited" and self.open is not None
        replaced = {"closed": self.rough, "gas_conductivity": tabulated}
        for key in type(self).model_fields:
            given = key in self.model_fields_set
            if key in needed and not given and not replaced.get(key, False):
                yield Problem((key,), f"missing; the law {self.law!r} needs it")
            if given and key not in (*usable, "law", "patches"):
                used = ", ".join(usable) or "no further numbers"
                yield Problem((key,), f"the law {self.law!r} takes {used}")
        if self.law == "perfect" and self.patches:
            yield Problem(("patches",), "perfect contact has no parts")
        if self.open is not None and self.law == "limited":
            for key in ("gas_conductivity", "transition"):
                if key in self.model_fields_set and not (key == "gas_conductivity" and self.rough):
                    yield Problem((key,), "open is given already; leave one of them out")

    def _roughness_problems(self) -> Iterator[Problem]:
        pressure = self.pressure
        lacks = pressure is not None and pressure.resistance is None and not pressure.rough
        if lacks and not self.rough:
            text = "missing; give it, or roughness and coating"
            yield Problem(("pressure", "resistance"), text)
        for key in _ROUGH:
            if getattr(self, key) is not None and self.closed is not None and not lacks:
                text = "not used: closed is given, and no pressure term needs it; leave one out"
                yield Problem((key,), text)
        depths = [self.roughness, None if pressure is None else pressure.roughness]
        if any(depths) and self.gas_conductivity is None:
            yield Problem(("gas_conductivity",), "missing; the gas in the roughness needs it")
        if self.law == "constant" and self.gas_conductivity is not None and not any(depths):
            yield Problem(("gas_conductivity",), "the law 'constant' needs it for roughness only")

    def _variation_problems(self) -> Iterator[Problem]:
        for (law, key), allowed in _OVER.items():
            variation = getattr(self, key)
            if self.law != law or variation is None:
                continue
            if variation.over not in allowed and not (variation.is_constant and "time" in allowed):
                text = f"in the law {law!r} it varies over {' or '.join(allowed)}"
                yield Problem((key,), f'{text}: {{ over = "{allowed[0]}", table = ... }}')

    def _closure_problems(self) -> Iterator[Problem]:
        """Yield a jump of the coefficient at closure."""
        if self.law != "limited" or self.open is None:
            return
        at_closure, closed = float(self.open.table(0.0)), self._largest_closed()
        if at_closure < closed * (1.0 - 1e-12):
            text = f"{at_closure:g} W/m²/K at gap 0, but closed is {closed:g}"
            yield Problem(("open",), f"{text}: the law would jump; at gap 0 it must not be smaller")

    def _largest_closed(self) -> float:
        """Return the largest coefficient of touching surfaces without pressure."""
        if self.closed is not None:
            table = self.closed.table
            return float(table(0.0) if self.closed.over == "pressure" else table.values.max())
        depth = mean_depth(self.roughness)
        fixed = 0.0 if self.coating is None else self.coating.resistance
        gas = 1.0 if self.gas_conductivity is None else self.gas_conductivity.table.values.max()
        return 1.0 / (depth / float(gas) + fixed)

    def _patch_problems(self) -> Iterator[Problem]:
        for index, patch in enumerate(self.patches):
            try:
                heat = self.on(patch)
            except Refusal as error:
                yield from error.inside("patches", index).problems
                continue
            if heat.law == "perfect":
                text = "perfect contact has no parts; give a large closed"
                yield Problem(("patches", index, "law"), text)

    def on(self, patch: Patch) -> InterfaceHeat:
        """Return the heat transfer on a patch: these keys and what is different there.

        A patch with a law of its own takes nothing from here but the radiation.

        Raises:
            Refusal: the keys do not fit together.
        """
        kept = {"radiation"} if "law" in patch.changes else set(type(self).model_fields)
        own = {k: getattr(self, k) for k in kept & self.model_fields_set if k != "patches"}
        return InterfaceHeat.read(own | dict(patch.changes))


def mean_depth(roughness: tuple[float, ...] | None) -> float:
    """Return R_z = ½√(R₁² + R₂²) of both sides [m]; zero without roughness."""
    return 0.0 if roughness is None else 0.5 * math.hypot(*roughness)
