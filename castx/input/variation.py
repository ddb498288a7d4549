"""Coefficients that are constant or vary with one quantity: time, temperature, gap, pressure."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from castx.errors import CaseError
from castx.input.entries import TEMPERATURES, TIMES, Choice, Quantity, Tabulated
from castx.input.problems import Refusal, among, refuse
from castx.input.units import LENGTH, STRESS
from castx.tables import Table

ARGUMENTS = {
    "temperature": TEMPERATURES,
    "time": TIMES,
    "gap": Quantity(LENGTH, least=0.0),
    "pressure": Quantity(STRESS, least=0.0),
}
"""What a coefficient may vary with, and the kind of the first column of its table."""


@dataclass(frozen=True, eq=False)
class Variation:
    """A coefficient over one quantity.

    Args:
        table: of the coefficient, in SI.
        over: the quantity, one of `ARGUMENTS`.
        of: whose temperature counts, where that is the quantity.
    """

    table: Table
    over: str = "time"
    of: str = ""

    @classmethod
    def constant(cls, value: float) -> Variation:
        """Return a coefficient that does not vary."""
        return cls(Table.constant(value))

    @property
    def is_constant(self) -> bool:
        """Whether it has one value throughout."""
        return self.table.is_constant


@dataclass(frozen=True)
class Varying:
    """A number or { over = "...", table = [[...], ...] }, for `Annotated[Variation, Varying(...)]`.

    Args:
        value: kind of the coefficient.
        over: quantities it may vary with.
        of: temperatures it may vary with, the default first.
        rows: whether plain rows are allowed too, a table over time.
        ends_at_zero: quantities over which the last row of a table may be 0, where numbers are
            positive else.
    """

    value: Quantity
    over: tuple[str, ...]
    of: tuple[str, ...] = ()
    rows: bool = field(default=False)
    ends_at_zero: tuple[str, ...] = ()

    def read(self, value: Any) -> Variation:
        """Return the coefficient.

        Raises:
            Refusal: with the offending key or row.
        """
        if isinstance(value, Variation):
            return value
        if isinstance(value, Table) or (self.rows and isinstance(value, list | tuple)):
            return Variation(Tabulated(self.value, TIMES).read(value))
        if not isinstance(value, dict):
            if isinstance(value, list | tuple):
                names = " or ".join(f'"{name}"' for name in self.over)
                raise CaseError(f"a table needs its argument: {{ over = {names}, table = [...] }}")
            return Variation.constant(self.value.read(value))
        known = ("over", "table", "of")
        for key in value:
            if key not in known:
                raise refuse(f"unknown key; {among(key, known, what='known keys')}", key)
        for key in ("over", "table"):
            if key not in value:
                raise refuse("missing; both over and table are needed", key)
        over = self._choice("over", self.over, value["over"])
        try:
            table = self._table(over, value["table"])
        except Refusal as error:
            raise error.inside("table") from None
        except CaseError as error:
            raise refuse(str(error), "table") from None
        return Variation(table, over, self._read_of(over, value))

    def _table(self, over: str, rows: Any) -> Table:
        if over not in self.ends_at_zero:
            return Tabulated(self.value, ARGUMENTS[over]).read(rows)
        kind = replace(self.value, above=-math.inf, least=0.0)
        table = Tabulated(kind, ARGUMENTS[over]).read(rows)
        if (table.values[:-1] == 0.0).any() or len(table.values) == 1:
            for value in table.values:
                self._positive(float(value), over)
        return table

    def _positive(self, value: float, over: str) -> None:
        try:
            self.value.read(value)
        except CaseError as error:
            raise CaseError(f"{error}; only the last row over {over} may be 0") from None

    def _read_of(self, over: str, value: dict[str, Any]) -> str:
        if over != "temperature":
            if "of" in value:
                raise refuse(f"only a table over temperature has it, not one over {over}", "of")
            return ""
        return self._choice("of", self.of, value.get("of", self.of[0]))

    def _choice(self, key: str, names: tuple[str, ...], value: Any) -> str:
        try:
            return Choice(names).read(value)
        except CaseError as error:
            raise refuse(str(error), key) from None

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)
