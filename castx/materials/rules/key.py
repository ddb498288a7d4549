"""A key that a rule reads from the case file: its kind, unit, default and meaning."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from castx.errors import CaseError
from castx.input.entries import Quantity, Tabulated
from castx.input.units import Dimension
from castx.tables import Table


class TableEntry(Protocol):
    """Kind of a number that may be a table over temperature."""

    def read(self, value: Any) -> Table:
        """Return the table of a value of the case file."""
        ...


@dataclass(frozen=True)
class PeoplesUnit:
    """Unit in which people state a property.

    Attributes:
        unit: its name.
        factor: number in this unit over the number in SI.
    """

    unit: str
    factor: float


@dataclass(frozen=True)
class RuleKey:
    """One key of a rule.

    Attributes:
        name: in the case file.
        meaning: quantity, with its sign in the formula.
        entry: kind of its values, with dimension and bounds.
        written_unit: SI unit where it is not the unit of the entry's dimension.
        default: value where the key is not given; None: the rule needs the key.
        shown: unit in which people state it; None: the SI unit.
    """

    name: str
    meaning: str
    entry: TableEntry
    written_unit: str = ""
    default: float | None = None
    shown: PeoplesUnit | None = None

    @property
    def unit(self) -> str:
        """SI unit, "" for a pure number."""
        if self.written_unit or not isinstance(self.entry, Tabulated):
            return self.written_unit
        return unit_text(self.entry.value.dimension)

    @property
    def default_table(self) -> Table | None:
        """The default as a table; None where the rule needs the key."""
        return None if self.default is None else Table.constant(self.default)

    @property
    def text(self) -> str:
        """The key with its unit and default, for tables of the manual."""
        unit = f" [{self.unit}]" if self.unit else ""
        return f"{self.name}{unit}" + ("" if self.default is None else f" = {self.default:g}")


@dataclass(frozen=True)
class PlainQuantity(Quantity):
    """A number that cannot be written with its unit.

    Args:
        reason: why it cannot, for messages.
    """

    reason: str = "its unit depends on the exponent n"

    def read(self, value: Any) -> float:
        """Return the number.

        Raises:
            CaseError: it is not a plain number, or out of range.
        """
        if isinstance(value, str):
            why = f": {self.reason}" if self.reason else ""
            raise CaseError(f"a plain number in {self.dimension.unit} is needed{why}")
        return super().read(value)


def unit_text(dimension: Dimension) -> str:
    """Return the SI unit of a dimension as people write it, "" for a pure number."""
    text = dimension.shown.replace("*", " ")
    return text.replace("^2", "²").replace("^3", "³")
