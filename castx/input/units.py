"""Numbers of a case file: plain in SI (temperatures in °C), or strings that carry their unit."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from typing import Any

import pint

from castx.errors import CaseError

ABSOLUTE_ZERO = -273.15  # °C
HOTTEST = 10_000.0  # °C; every element boils below 6000 °C

_LONGEST_TEXT = 80
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_TERM = r"[A-Za-zµμΩ°%_]+(?:\s?(?:\^|\*\*)\s?-?\d|[²³])?"
_AND = r"(?:\s?[*/·]\s?|\s)"
_GROUP = rf"\(\s?{_TERM}(?:{_AND}{_TERM})*\s?\)"
_UNIT = re.compile(rf"(?:1?\s?/\s?)?(?:{_TERM}|{_GROUP})(?:{_AND}(?:{_TERM}|{_GROUP}))*")
_SPELLINGS = str.maketrans({"·": "*", "²": "^2", "³": "^3", "μ": "µ"})


@dataclass(frozen=True)
class Dimension:
    """A kind of physical quantity.

    Args:
        name: with its article, for messages ("a length").
        unit: SI unit of the stored number; "degC" marks absolute temperatures.
        units: units in common use, for messages.
        difference: whether temperatures in it are differences, so that 20 °C means 20 K.
    """

    name: str
    unit: str
    units: tuple[str, ...] = ()
    difference: bool = True

    @property
    def example(self) -> str:
        """A number with a unit as it may stand in a case file."""
        return f'"2 {self.units[0] if self.units else self.unit}"' if self.unit else "2"


LENGTH = Dimension("a length", "m", ("mm", "cm", "m", "um", "inch"))
TIME = Dimension("a time", "s", ("s", "ms", "min", "h"))
TEMPERATURE = Dimension("a temperature", "degC", ("degC", "K", "degF"), difference=False)
TEMPERATURE_DIFFERENCE = Dimension("a temperature difference", "K", ("K", "degC"))
DENSITY = Dimension("a density", "kg/m^3", ("kg/m^3", "g/cm^3"))
HEAT_CAPACITY = Dimension("a heat capacity per mass", "J/kg/K", ("J/kg/K", "kJ/kg/K"))
CONDUCTIVITY = Dimension("a thermal conductivity", "W/m/K", ("W/m/K", "W/mm/K"))
LATENT_HEAT = Dimension("a heat per mass", "J/kg", ("J/kg", "kJ/kg"))
STRESS = Dimension("a pressure or stress", "Pa", ("MPa", "GPa", "kPa", "Pa", "bar", "N/mm^2"))
ANGLE = Dimension("an angle", "deg", ("deg", "rad"))
FORCE = Dimension("a force", "N", ("kN", "MN", "N"))
STIFFNESS = Dimension("a stiffness", "N/m", ("MN/mm", "kN/mm", "N/m"))
PENALTY = Dimension("a pressure per length", "Pa/m", ("Pa/m", "GPa/m", "MPa/mm"))
EXPANSION = Dimension("a thermal expansion", "1/K", ("1/K", "um/m/K"))
VISCOSITY = Dimension("a viscosity", "Pa*s", ("Pa*s", "MPa*s"))
ACTIVATION_ENERGY = Dimension("an activation energy", "J/mol", ("J/mol", "kJ/mol"))
NORTON_COEFFICIENT = Dimension("a Norton coefficient", "1/(s*Pa^n)")
HEAT_FLUX = Dimension("a heat flux", "W/m^2", ("W/m^2", "kW/m^2"))
HEAT_SOURCE = Dimension("a heat source per volume", "W/m^3", ("W/m^3", "kW/m^3"))
HEAT_TRANSFER = Dimension("a heat-transfer coefficient", "W/m^2/K", ("W/m^2/K", "kW/m^2/K"))
THERMAL_RESISTANCE = Dimension("a thermal resistance of a surface", "m^2*K/W", ("m^2*K/W",))
ACCELERATION = Dimension("an acceleration", "m/s^2", ("m/s^2", "mm/s^2"))
PURE_NUMBER = Dimension("a number without unit", "", ())


@cache
def registry() -> pint.UnitRegistry:
    """Return the table of units, read once."""
    return pint.UnitRegistry()


def number(value: Any, dimension: Dimension) -> float:
    """Return a plain number, or a text with a unit, in the SI unit of a dimension.

    Raises:
        CaseError: neither of both, not finite, an unknown unit, the unit of another dimension, or
            a temperature below absolute zero or above `HOTTEST`.
    """
    result = _convert(value, dimension) if isinstance(value, str) else _plain(value, dimension)
    if not math.isfinite(result):
        raise CaseError(f"{dimension.name} must be finite")
    if dimension is TEMPERATURE and result < ABSOLUTE_ZERO:
        raise CaseError(f"below absolute zero, {ABSOLUTE_ZERO} °C (plain numbers are in °C)")
    if dimension is TEMPERATURE and result > HOTTEST:
        raise CaseError(f"above {HOTTEST:g} °C, where every metal is vapour")
    return result


def _plain(value: Any, dimension: Dimension) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise CaseError(
            f"{dimension.name} is needed: a number{_in_unit(dimension)}{_or_text(dimension)}"
        )
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _convert(text: str, dimension: Dimension) -> float:
    text = " ".join(text.split())
    match = _NUMBER.match(text) if len(text) <= _LONGEST_TEXT else None
    if match is None:
        raise CaseError(
            f"{dimension.name} is needed: a number{_in_unit(dimension)}{_or_text(dimension)}"
        )
    unit = text[match.end() :].strip()
    if not unit:
        raise CaseError(
            f"a number in quotes needs a unit: write it without quotes{_in_unit(dimension)}"
            f"{_or_text(dimension)}"
        )
    return _in_si(float(match.group()), unit, dimension)


def converted(amount: float, unit: str, wanted: str) -> float:
    """Return a number in another unit of the same kind; "°C" is an absolute temperature.

    Raises:
        CaseError: a unit is unknown, or they are of different kinds.
    """
    spelled = wanted.translate(_SPELLINGS).replace("°C", "degC")
    absolute = spelled in ("degC", "K", "degF") and unit in ("°C", "degC", "K", "degF")
    goal = Dimension(f"a number in {wanted or 'no unit'}", spelled, difference=not absolute)
    return _in_si(amount, unit.replace("°C", "degC") or "dimensionless", goal)


def _in_si(amount: float, text: str, dimension: Dimension) -> float:
    unit = _unit(text, dimension)
    table = registry()
    si = table.Unit(dimension.unit or "dimensionless")
    if unit.dimensionality != si.dimensionality or _is_difference(unit, dimension):
        raise _wrong_unit(text, dimension)
    if dimension.difference and str(unit) in ("degree_Celsius", "degree_Fahrenheit"):
        unit = table.Unit(f"delta_{unit}")
    try:
        nothing, result = (float(table.Quantity(x, unit).to(si).magnitude) for x in (0.0, amount))
    except Exception:  # pint meets logarithms and scales with an origin in products with others
        raise _wrong_unit(text, dimension) from None
    if dimension.difference and nothing != 0.0:  # a logarithm, or a scale with an origin
        raise _wrong_unit(text, dimension)
    return result


def _wrong_unit(text: str, dimension: Dimension) -> CaseError:
    return CaseError(
        f"{text!r} is not a unit of {dimension.name.removeprefix('a ').removeprefix('an ')}; "
        f"{dimension.name} is needed{_in_unit(dimension)}{_or_text(dimension)}"
    )


def _is_difference(unit: pint.Unit, dimension: Dimension) -> bool:
    """Whether a unit of temperature differences stands where an absolute temperature is needed."""
    return not dimension.difference and str(unit).startswith("delta_")


def _unit(text: str, dimension: Dimension) -> pint.Unit:
    spelled = text.translate(_SPELLINGS)
    if _UNIT.fullmatch(spelled):
        try:
            unit = registry().parse_units(f"1{spelled}" if spelled.startswith("/") else spelled)
            _ = unit.dimensionality  # raises for products of logarithms
            return unit
        except Exception:  # unknown to pint, or more than it can take
            pass
    near = get_close_matches(text, dimension.units, n=1)
    raise CaseError(
        f"unknown unit {text!r}; {dimension.name} is needed{_in_unit(dimension)}"
        f"{_or_text(dimension)}" + (f" (did you mean {near[0]!r}?)" if near else "")
    )


def _in_unit(dimension: Dimension) -> str:
    return f" in {dimension.unit.replace('degC', '°C')}" if dimension.unit else ""


def _or_text(dimension: Dimension) -> str:
    if not dimension.units:
        return ""
    return f", or a string with a unit such as {', '.join(dimension.units)}: {dimension.example}"
