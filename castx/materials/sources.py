"""Sources of the numbers of a material, and the temperatures between which they are valid."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import chain
from typing import Any, NamedTuple, get_args

from castx.input.entries import Description, Quantity, Tabulated
from castx.materials.description import Liquid, LiquidEntry, MaterialDescription, PhasedTable
from castx.materials.foundry_data import KeysEntry
from castx.materials.inelastic import (
    KINEMATIC_KEYS,
    LIQUID_RULES,
    RATE_KEYS,
    Hardening,
    HardeningEntry,
    KeyEntry,
)
from castx.materials.phased import Phased
from castx.materials.rules.declaration import keys_of
from castx.materials.rules.key import PeoplesUnit, RuleKey, unit_text
from castx.materials.solid_fraction import TabulatedLaw
from castx.tables import Table

CASE_FILE = "case file"
DEFAULT = "default of castx"
_BOTH_PHASES = ("heat_capacity", "conductivity")

Value = float | str | Table | TabulatedLaw


class Unit(NamedTuple):
    """Unit of a property.

    Attributes:
        si: SI unit, "" for a pure number.
        people: unit in which people state it.
        factor: number in the unit of people over the number in SI.
    """

    si: str
    people: str
    factor: float


@dataclass(frozen=True)
class Spread:
    """The range in which a property may lie.

    Args:
        low: lowest number, in the unit of the property, or factor.
        high: highest one.
        by_factor: whether they multiply the property, as they do a table.
        source: where the range comes from.
    """

    low: float
    high: float
    by_factor: bool
    source: str


@dataclass(frozen=True)
class Source:
    """Origin of one property.

    Args:
        text: author, year, table or equation.
        valid: temperatures between which it is valid [°C]; None: it does not depend on them.
        spread: in which it may lie; None: not known.
    """

    text: str
    valid: tuple[float, float] | None = None
    spread: Spread | None = None


class Property(NamedTuple):
    """One property of a material, with all that is known of it.

    Args:
        name: dotted, as `conductivity.solid`.
        value: in `unit`.
        unit: SI.
        source: where it comes from.
        valid: temperatures between which it is valid [°C]; None: everywhere.
        spread: in which it may lie; None: not known.
    """

    name: str
    value: Value
    unit: str
    source: str
    valid: tuple[float, float] | None
    spread: Spread | None = None


class PropertyRow(NamedTuple):
    """One number of a material for people to read."""

    property: str
    temperature: float | None
    value: float | str
    unit: str
    source: str


class OutsideRange(NamedTuple):
    """A property that is used outside the temperatures for which it is valid [°C]."""

    property: str
    valid: tuple[float, float]
    asked: tuple[float, float]

    def beyond(self) -> float:
        """Distance of the farthest temperature from the range [K]."""
        return max(self.valid[0] - self.asked[0], self.asked[1] - self.valid[1])


def unit_of(name: str) -> Unit | None:
    """Return the unit of a property, dotted, as `conductivity.solid`; None: no such property."""
    first, _, last = name.partition(".")
    if last in ("solid", "liquid"):
        name = first
    elif name == "hardening":
        name = "hardening.linear"
    return _units().get(name)


@cache
def _units() -> dict[str, Unit]:
    """Return the units of all properties by dotted name, in the order of the case format."""
    units: dict[str, Unit] = {}
    placed = {"hardening": KINEMATIC_KEYS, "law": RATE_KEYS}
    for name, kinds in _fields(MaterialDescription, placed):
        tables = [kind for kind in kinds if isinstance(kind, KeysEntry)]
        if tables:
            inner = _fields(tables[0].model, {})
        elif any(isinstance(kind, LiquidEntry) for kind in kinds):
            inner = _fields(Liquid, {"viscosity": keys_of(LIQUID_RULES.values())})
        elif any(isinstance(kind, HardeningEntry) for kind in kinds):
            inner = _fields(Hardening, {})
        else:
            units |= {name: _unit(kinds)} if name != "extends" else {}
            continue
        units |= {f"{name}.{key}": _unit(parts) for key, parts in inner}
    return units


def _fields(
    model: type[Description], placed: Mapping[str, Mapping[str, RuleKey]]
) -> Iterator[tuple[str, Sequence[object]]]:
    """Yield the fields of a description with the kinds of their values.

    Args:
        model: class of the description.
        placed: keys of rules by the field that they follow in the case format.
    """
    later = {name for keys in placed.values() for name in keys}
    for name, field in model.model_fields.items():
        if name not in later:
            inner = (getattr(part, "__metadata__", ()) for part in get_args(field.annotation))
            yield name, [*field.metadata, *chain.from_iterable(inner)]
        yield from ((key, [KeyEntry(placed[name][key])]) for key in placed.get(name, ()))


def _unit(kinds: Sequence[object]) -> Unit:
    """Return the unit of a property from the kinds of its values."""
    si, shown = "", None
    for kind in kinds:
        if isinstance(kind, KeyEntry):
            si, shown = kind.key.unit, kind.key.shown
        elif isinstance(kind, PhasedTable):
            si = unit_text(kind.table.value.dimension)
        elif isinstance(kind, Tabulated):
            si = unit_text(kind.value.dimension)
        elif isinstance(kind, Quantity):
            si = unit_text(kind.dimension)
        elif isinstance(kind, PeoplesUnit):
            shown = kind
    return Unit(si, shown.unit, shown.factor) if shown else Unit(si, si, 1.0)


def properties(
    description: MaterialDescription, sources: Mapping[str, Source]
) -> Iterator[Property]:
    """Yield all given properties in the order of the case format."""
    for name, value in _values(description):
        source = _source(name, sources)
        given = name.partition(".")[0] in description.model_fields_set
        text = source.text if source else CASE_FILE if given else DEFAULT
        unit = unit_of(name)
        si = unit.si if unit else ""
        spread = source.spread if source else None
        yield Property(name, value, si, text, _valid(name, value, sources), spread)


def property_rows(
    description: MaterialDescription, sources: Mapping[str, Source]
) -> Iterator[PropertyRow]:
    """Yield all numbers of a material, tables row by row, in the order of the case format."""
    for item in properties(description, sources):
        for temperature, number in numbers(item.value):
            yield PropertyRow(item.name, temperature, number, item.unit, item.source)


def outside_range(
    description: MaterialDescription,
    sources: Mapping[str, Source],
    lowest: float,
    highest: float,
    near: float,
) -> list[OutsideRange]:
    """Return the properties that temperatures from lowest to highest [°C] take out of range.

    A property of the solid is not asked above the solidus, one of the liquid not below the
    liquidus: that each goes on unchanged through the freezing range is part of the model. Without
    a stated range a table is valid between its ends and a number everywhere. Temperatures may lie
    outside by as much as near [K].
    """
    solidus, liquidus = description.freezing_range or (highest, lowest)
    result = []
    for name, value in _values(description):
        valid = _valid(name, value, sources)
        flowing = "liquid" in name.split(".")
        start = max(lowest, liquidus) if flowing else lowest
        end = highest if flowing or name in _BOTH_PHASES else min(highest, solidus)
        if valid is None or start > end:
            continue
        if start + near < valid[0] or end - near > valid[1]:
            result.append(OutsideRange(name, valid, (start, end)))
    return result


def _values(description: MaterialDescription) -> Iterator[tuple[str, Value]]:
    """Yield the dotted names and values of all given properties."""
    for name in _units():
        value: Any = description
        for key in name.split("."):
            # The law of the solid fraction is shown even where it is the default.
            given = value is not None and key in value.model_fields_set | {"solid_fraction"}
            value = getattr(value, key) if given else None
        if name == "solid_fraction" and not _freezes_by_law(description):
            continue
        if isinstance(value, Phased) and value.solid is not value.liquid:
            yield f"{name}.solid", value.solid
            yield f"{name}.liquid", value.liquid
        elif value is not None:
            yield name, value.solid if isinstance(value, Phased) else value


def _freezes_by_law(description: MaterialDescription) -> bool:
    """Whether a law of the solid fraction acts; an isothermal change needs none."""
    if description.freezing_range is None:
        return False
    solidus, liquidus = description.freezing_range
    return "solid_fraction" in description.model_fields_set or solidus < liquidus


def numbers(value: Value) -> Iterator[tuple[float | None, float | str]]:
    """Yield the rows (°C, number) of a table, or (None, number) of a single number."""
    if isinstance(value, TabulatedLaw):
        yield from value.rows
    elif not isinstance(value, Table):
        yield None, value
    elif value.is_constant:
        yield None, float(value.values[0])
    else:
        for temperature, number in zip(value.arguments, value.values, strict=True):
            yield float(temperature), float(number)


def _source(name: str, sources: Mapping[str, Source]) -> Source | None:
    """Return the source of a property, or of the whole of which the property is a part."""
    return sources.get(name) or sources.get(name.rpartition(".")[0])


def _valid(name: str, value: Value, sources: Mapping[str, Source]) -> tuple[float, float] | None:
    source = _source(name, sources)
    if source is not None and source.valid is not None:
        return source.valid
    if isinstance(value, Table) and not value.is_constant:
        return float(value.arguments[0]), float(value.arguments[-1])
    return None
