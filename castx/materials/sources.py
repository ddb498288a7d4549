"""Where the numbers of a material come from, and between which temperatures they hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from castx.materials.description import MaterialDescription
from castx.materials.phased import Phased
from castx.materials.solid_fraction import TabulatedLaw
from castx.tables import Table

CASE_FILE = "case file"
DEFAULT = "default of castx"
_BOTH_PHASES = ("heat_capacity", "conductivity")

_UNITS = {
    "density": "kg/m³",
    "heat_capacity": "J/kg/K",
    "conductivity": "W/m/K",
    "latent_heat": "J/kg",
    "solidus": "°C",
    "liquidus": "°C",
    "solid_fraction": "",
    "partition_coefficient": "",
    "melting_point": "°C",
    "young_modulus": "Pa",
    "poisson_ratio": "",
    "expansion": "1/K",
    "expansion_reference": "°C",
    "stress_free": "°C",
    "solidification_shrinkage": "",
    "yield_stress": "Pa",
    "hardening.linear": "Pa",
    "hardening.saturation": "Pa",
    "hardening.rate": "",
    "kinematic_hardening": "Pa",
    "law": "",
    "viscosity": "Pa s^(1/exponent)",
    "exponent": "",
    "coefficient": "1/(s Pa^exponent)",
    "activation_energy": "J/mol",
    "dissipation": "",
    "liquid.model": "",
    "liquid.viscosity": "Pa s",
    "liquid.coefficient": "1/(s Pa^exponent)",
    "liquid.exponent": "",
    "liquid.activation_energy": "J/mol",
    "liquid.coherency": "",
}

Value = float | str | Table | TabulatedLaw


@dataclass(frozen=True)
class Source:
    """Origin of one property.

    Args:
        text: author, year, table or equation.
        valid: temperatures between which it holds [°C]; None when it is no function of them.
    """

    text: str
    valid: tuple[float, float] | None = None


class Property(NamedTuple):
    """One property of a material, with all that is known of it.

    Args:
        name: dotted, as `conductivity.solid`.
        value: in `unit`.
        unit: SI.
        source: where it comes from.
        valid: temperatures between which it holds [°C]; None: everywhere.
    """

    name: str
    value: Value
    unit: str
    source: str
    valid: tuple[float, float] | None


class PropertyRow(NamedTuple):
    """One number of a material for people to read."""

    property: str
    temperature: float | None
    value: float | str
    unit: str
    source: str


class OutsideRange(NamedTuple):
    """A property that is used outside the temperatures for which it holds [°C]."""

    property: str
    valid: tuple[float, float]


def unit_of(name: str) -> str | None:
    """Return the SI unit of a property, dotted, "" for pure numbers; None: no such property."""
    first, _, last = name.partition(".")
    if last in ("solid", "liquid"):
        name = first
    elif name == "hardening":
        name = "hardening.linear"
    return _UNITS.get(name)


def properties(
    description: MaterialDescription, sources: Mapping[str, Source]
) -> Iterator[Property]:
    """Yield all given properties in the order of the case format."""
    for name, value in _values(description):
        source = _source(name, sources)
        given = name.partition(".")[0] in description.model_fields_set
        text = source.text if source else CASE_FILE if given else DEFAULT
        yield Property(name, value, unit_of(name) or "", text, _valid(name, value, sources))


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
) -> list[OutsideRange]:
    """Return the properties that temperatures from lowest to highest [°C] take out of range.

    A property of the solid is not asked above the solidus, one of the liquid not below the
    liquidus: that each goes on unchanged through the freezing range is part of the model. Without
    a stated range a table holds between its ends and a number everywhere.
    """
    solidus, liquidus = description.freezing_range or (highest, lowest)
    result = []
    for name, value in _values(description):
        valid = _valid(name, value, sources)
        flowing = "liquid" in name.split(".")
        start = max(lowest, liquidus) if flowing else lowest
        end = highest if flowing or name in _BOTH_PHASES else min(highest, solidus)
        if valid is not None and start <= end and not (valid[0] <= start and end <= valid[1]):
            result.append(OutsideRange(name, valid))
    return result


def _values(description: MaterialDescription) -> Iterator[tuple[str, Value]]:
    """Yield the dotted names and values of all given properties."""
    for name in _UNITS:
        value: Any = description
        for key in name.split("."):
            # The law of the solid fraction is worth a line even where the default holds.
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
    """Yield the rows (°C, number) of a table; what is no function of temperature has no °C."""
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
    """Return the source of a property, or that of the whole it belongs to."""
    return sources.get(name) or sources.get(name.rpartition(".")[0])


def _valid(name: str, value: Value, sources: Mapping[str, Source]) -> tuple[float, float] | None:
    source = _source(name, sources)
    if source is not None and source.valid is not None:
        return source.valid
    if isinstance(value, Table) and not value.is_constant:
        return float(value.arguments[0]), float(value.arguments[-1])
    return None
