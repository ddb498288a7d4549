"""Numbers of a study, which keep the unit in which they are written.

A path of the case file does not tell what kind of quantity it leads to, so that a number goes back
into the case as it was given, and the case refuses what does not belong there.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from castx.errors import CaseError
from castx.input.problems import show
from castx.input.units import registry

_WRITTEN = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(\S.*)?")
NEEDED = 'a number is needed, plain in SI or with its unit: 2300 or "2300 W/m^2/K"'


@dataclass(frozen=True)
class Amount:
    """A number and its unit, for `Annotated[Amount, AMOUNT]`.

    Attributes:
        value: in the unit.
        unit: as it was written; "": plain, in SI, temperatures in °C.
    """

    value: float
    unit: str = ""

    def written(self, value: float) -> float | str:
        """Return another value in the same unit, as a case file writes it."""
        return f"{float(value)!r} {self.unit}" if self.unit else float(value)


def amount(value: Any) -> Amount:
    """Return a number of a case file with its unit.

    Raises:
        CaseError: it is none, or not finite.
    """
    if isinstance(value, Amount):
        return value
    unit = ""
    if isinstance(value, str):
        match = _WRITTEN.fullmatch(value)
        if match is None:
            raise CaseError(NEEDED)
        number, unit = float(match[1]), (match[2] or "").strip()
    elif isinstance(value, int | float) and not isinstance(value, bool):
        number = float(value)
    else:
        raise CaseError(NEEDED)
    if not math.isfinite(number):
        raise CaseError("must be finite")
    return Amount(number, unit)


@dataclass(frozen=True)
class AmountEntry:
    """Kind of an entry that is an `Amount`."""

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(amount)


AMOUNT = AmountEntry()


def other_unit(amounts: Sequence[Amount | None]) -> str:
    """Return the problem of numbers of one quantity in different units; "" if there is none."""
    units = list(dict.fromkeys(one.unit for one in amounts if one is not None))
    if len(units) < 2:
        return ""
    named = " and ".join(show(unit) if unit else "no unit" for unit in units[:2])
    return f"has numbers with {named}: write all of them in the same unit"


def in_unit(given: Amount, unit: str) -> float:
    """Return a number of the case in the unit of a study.

    Args:
        given: the number.
        unit: "" is SI.

    Raises:
        CaseError: it cannot be said in this unit.
    """
    if given.unit == unit:
        return given.value
    table = registry()
    try:
        known = table.Unit(given.unit or unit)
        if known.dimensionality == table.Unit("kelvin").dimensionality:
            raise CaseError("a temperature or a difference of temperatures")
        base = table.Quantity(1.0, known).to_base_units().units
        start = table.Quantity(given.value, known if given.unit else base)
        return float(start.to(table.Unit(unit) if unit else base).magnitude)
    except Exception:  # pint raises errors of many kinds
        has = f'"{given.value:g} {given.unit}"' if given.unit else f"{given.value:g}"
        wanted = show(unit) if unit else "no unit"
        raise CaseError(
            f"the case has {has} there, the study {wanted}: write both in the same unit"
        ) from None
