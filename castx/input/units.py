"""Numbers of a case file: plain in SI (temperatures in °C), or strings that carry their unit."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from typing import TYPE_CHECKING, Any

from castx.errors import CaseError

if TYPE_CHECKING:
    import pint

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
    def shown(self) -> str:
        """SI unit as it is shown, with °C."""
        return self.unit.replace("degC", "°C")

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

FACTORS: dict[str, dict[str, float]] = {
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "inch": 0.0254},
    "s": {"s": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0},
    "degC": {"degC": 1.0, "°C": 1.0},
    "K": {"K": 1.0, "degC": 1.0, "°C": 1.0},
    "kg/m^3": {"kg/m^3": 1.0, "g/cm^3": 999.9999999999999},
    "J/kg/K": {"J/kg/K": 1.0, "kJ/kg/K": 1e3},
    "W/m/K": {"W/m/K": 1.0, "W/mm/K": 1e3},
    "J/kg": {"J/kg": 1.0, "kJ/kg": 1e3},
    "Pa": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "bar": 1e5, "N/mm^2": 1e6},
    "deg": {"deg": 1.0, "rad": 57.29577951308232},
    "N": {"N": 1.0, "kN": 1e3, "MN": 1e6},
    "N/m": {"N/m": 1.0, "kN/mm": 1e6, "MN/mm": 1e9},
    "Pa/m": {"Pa/m": 1.0, "GPa/m": 1e9, "MPa/mm": 1e9, "GPa/mm": 1e12},
    "1/K": {"1/K": 1.0, "um/m/K": 1e-6},
    "Pa*s": {"Pa*s": 1.0, "MPa*s": 1e6},
    "J/mol": {"J/mol": 1.0, "kJ/mol": 1e3},
    "W/m^2": {"W/m^2": 1.0, "kW/m^2": 1e3},
    "W/m^3": {"W/m^3": 1.0, "kW/m^3": 1e3},
    "W/m^2/K": {"W/m^2/K": 1.0, "kW/m^2/K": 1e3},
    "m^2*K/W": {"m^2*K/W": 1.0},
    "m/s^2": {"m/s^2": 1.0, "mm/s^2": 1e-3},
}
"""By SI unit the factors of the common units, to the last digit those of pint, whose table of all
units takes as long to read as the rest of a case."""


@cache
def registry() -> pint.UnitRegistry:
    """Return the table of units, read once."""
    import pint

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


def plain_text(value: float, digits: int = 4) -> str:
    """Return a number as text, such as "0.1235" and "28800": without powers of ten when large.

    Args:
        value: the number.
        digits: that count.
    """
    shown = f"{value:.{digits}g}"
    return f"{value:.0f}" if 10.0**digits <= abs(float(shown)) < 1e9 else shown


def seconds_text(time: float, digits: int = 4) -> str:
    """Return a time [s] as text with its unit, as `plain_text` has it."""
    return f"{plain_text(time, digits)} s"


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
    scaled = dimension.difference or dimension.unit == "degC"  # else one with another origin
    factor = FACTORS.get(dimension.unit, {}).get(text) if scaled else None
    return _by_pint(amount, text, dimension) if factor is None else amount * factor


def _by_pint(amount: float, text: str, dimension: Dimension) -> float:
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
    return f" in {dimension.shown}" if dimension.unit else ""


def _or_text(dimension: Dimension) -> str:
    if not dimension.units:
        return ""
    return f", or a string with a unit such as {', '.join(dimension.units)}: {dimension.example}"
