"""Numbers that vary from place to place and with time: by a formula, or by a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.input.coordinates import AXES, coordinate
from castx.input.entries import LONGEST_TABLE, TIMES, Choice, Quantity, Tabulated, over_time
from castx.input.formulas import Formula
from castx.input.problems import Refusal, among, refuse
from castx.input.units import LENGTH
from castx.tables import Table

NOW = "t"
"""Name of the time in formulas and tables."""
_PLACES = Quantity(LENGTH)


def _along(points: npt.ArrayLike, time: float, axis: str) -> FloatArray:
    if axis == NOW:
        return np.full(len(np.asarray(points)), time)
    return coordinate(points, axis)


@dataclass(frozen=True)
class PlacedFormula:
    """A number by a formula of coordinates [m] and time [s].

    Args:
        formula: in SI.
    """

    formula: Formula

    @property
    def axes(self) -> tuple[str, ...]:
        """The coordinates that it uses."""
        return tuple(axis for axis in (*AXES, NOW) if axis in self.formula.used)

    @property
    def text(self) -> str:
        """The formula."""
        return self.formula.text

    def __call__(self, points: npt.ArrayLike, time: float) -> FloatArray:
        """Return the numbers at points (n, gdim) [m] at a time [s], shape (n,)."""
        used = self.axes or AXES[:1]
        return self.formula({axis: _along(points, time, axis) for axis in used})


@dataclass(frozen=True, eq=False)
class PlacedTable:
    """A number by a table over one or two coordinates, linear between its points.

    Outside its points it is constant.

    Args:
        axes: one or two of `AXES` and `NOW`.
        places: increasing coordinates of each of them.
        values: at them, one dimension for each axis.
    """

    axes: tuple[str, ...]
    places: tuple[FloatArray, ...]
    values: FloatArray

    @property
    def text(self) -> str:
        """Range and axes."""
        along = " and ".join(self.axes)
        return f"{self.values.min():g} to {self.values.max():g} along {along}"

    def __call__(self, points: npt.ArrayLike, time: float) -> FloatArray:
        """Return the numbers at points (n, gdim) [m] at a time [s], shape (n,)."""
        first = _along(points, time, self.axes[0])
        if len(self.axes) == 1:
            return np.asarray(np.interp(first, self.places[0], self.values))
        second = _along(points, time, self.axes[1])
        (i, a), (j, b) = (
            _interval(given, at) for given, at in zip(self.places, (first, second), strict=True)
        )
        v = self.values
        low = (1.0 - b) * v[i, j] + b * v[i, j + 1]
        high = (1.0 - b) * v[i + 1, j] + b * v[i + 1, j + 1]
        return np.asarray((1.0 - a) * low + a * high)


Placed = PlacedFormula | PlacedTable
"""A number that varies from place to place, and may vary with time."""


def _interval(given: FloatArray, at: FloatArray) -> tuple[npt.NDArray[np.intp], FloatArray]:
    """Return the intervals of increasing places in which points lie, and how far along (n,)."""
    number = np.clip(np.searchsorted(given, at, side="right") - 1, 0, len(given) - 2)
    along = (at - given[number]) / (given[number + 1] - given[number])
    return number, np.clip(along, 0.0, 1.0)


@dataclass(frozen=True)
class Placing:
    """Kind of a number that varies: { formula } or { along, table }.

    Args:
        value: kind of the number.
        moving: whether it may vary with time too.
    """

    value: Quantity
    moving: bool = False

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of the coordinates that it may vary with."""
        return (*AXES, NOW) if self.moving else AXES

    def read(self, value: Mapping[str, Any]) -> Placed:
        """Return the formula or the table of the number.

        Raises:
            Refusal: with the offending key.
        """
        keys = ("formula",) if "formula" in value else ("along", "table")
        for key in value:
            if key not in keys:
                raise refuse(f"unknown key; {among(key, keys, what='known keys')}", key)
        for key in keys:
            if key not in value:
                raise refuse("missing; give along and table, or a formula", key)
        if "formula" in value:
            return self._formula(value["formula"])
        axes = self._axes(value["along"])
        try:
            return self._table(axes, value["table"])
        except Refusal as error:
            raise error.inside("table") from None
        except CaseError as error:
            raise refuse(str(error), "table") from None

    def _formula(self, text: Any) -> Placed:
        if not isinstance(text, str):
            raise refuse('a formula in quotes is needed, such as "1e5 - 7e4*z"', "formula")
        try:
            return PlacedFormula(Formula(text, self.axes))
        except CaseError as error:
            raise refuse(str(error), "formula") from None

    def _axes(self, along: Any) -> tuple[str, ...]:
        named = along if isinstance(along, list | tuple) else [along]
        if not 1 <= len(named) <= 2:
            raise refuse("one coordinate or a list of two is needed", "along")
        try:
            axes = tuple(Choice(self.axes).read(axis) for axis in named)
        except CaseError as error:
            raise refuse(str(error), "along") from None
        if len(set(axes)) < len(axes):
            raise refuse("two different coordinates are needed", "along")
        return axes

    def _table(self, axes: tuple[str, ...], rows: Any) -> Placed:
        over = [TIMES if axis == NOW else _PLACES for axis in axes]
        if len(axes) == 1:
            table = Tabulated(self.value, over[0]).read(rows)
            return PlacedTable(axes, (table.arguments,), table.values)
        if not isinstance(rows, list | tuple) or not 4 <= len(rows) <= LONGEST_TABLE:
            raise CaseError(f"4 to {LONGEST_TABLE} rows are needed: {' , '.join(axes)}, value")
        read = np.array([self._row(index, row, axes, over) for index, row in enumerate(rows)])
        return _gridded(axes, read)

    def _row(
        self, index: int, row: Any, axes: tuple[str, ...], over: list[Quantity]
    ) -> tuple[float, ...]:
        if not isinstance(row, list | tuple) or len(row) != 3:
            raise refuse(f"a row needs three numbers: {', '.join(axes)} and a value", index)
        try:
            numbers = (*(kind.read(given) for kind, given in zip(over, row, strict=False)),)
            return (*numbers, self.value.read(row[2]))
        except CaseError as error:
            raise refuse(str(error), index) from None


def _gridded(axes: tuple[str, ...], rows: FloatArray) -> PlacedTable:
    """Return the table whose rows (first, second, value) fill a grid, in any order."""
    first, i = np.unique(rows[:, 0], return_inverse=True)
    second, j = np.unique(rows[:, 1], return_inverse=True)
    values = np.full((len(first), len(second)), np.nan)
    values[i, j] = rows[:, 2]
    if min(values.shape) < 2 or np.isnan(values).any() or len(rows) != values.size:
        raise CaseError(
            f"the rows must fill a grid: each of {len(first)} values of {axes[0]} with each of "
            f"{len(second)} of {axes[1]} once, at least two of both; got {len(rows)} rows"
        )
    return PlacedTable(axes, (first, second), values)


@dataclass(frozen=True)
class PlacedOverTime:
    """A number, a table of it over time, or how it varies with place and time.

    Args:
        value: kind of the number.
    """

    value: Quantity

    def read(self, value: Any) -> Table | Placed:
        """Return the table over time, or how the number varies.

        Raises:
            Refusal: with the offending key or row.
        """
        if isinstance(value, Placed):
            return value
        if isinstance(value, dict):
            return Placing(self.value, moving=True).read(value)
        return Tabulated(self.value, TIMES).read(value)

    def json_schema(self) -> dict[str, Any]:
        """Return the JSON schema of the entry."""
        schema = over_time(self.value.dimension).json_schema()
        said = f"{schema['description']}; or {{ formula }} or {{ along, table }} of place and t"
        return {"type": [*schema["type"], "object"], "description": said}

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)
