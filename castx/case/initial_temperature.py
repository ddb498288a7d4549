"""The temperature of a body at the start: uniform, varying in space, or from a file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.input.coordinates import AXES, coordinate
from castx.input.entries import TEMPERATURES, Choice, Quantity, Tabulated
from castx.input.placed import Placed, PlacedFormula, PlacedTable, Placing
from castx.input.problems import Refusal, among, refuse
from castx.input.units import LENGTH
from castx.tables import Table

SUFFIXES = (".vtu", ".xdmf", ".hdf")
UNITS = ("degC", "K", "degF")
_LONGEST_NAME = 200


@dataclass(frozen=True)
class FieldFile:
    """A temperature field in a file of another program.

    Args:
        path: VTU, or XDMF or VTKHDF, of which the last moment counts.
        field: name of the field.
        unit: of its numbers, one of `UNITS`.
    """

    path: Path
    field: str
    unit: str = "degC"


@dataclass(frozen=True, eq=False)
class InitialTemperature:
    """Temperature of a body at the start: uniform, varying in space, or from a file [°C].

    Args:
        table: over the coordinate; constant where there is one number; None: otherwise given.
        along: coordinate of the table, one of `AXES`.
        file: the file.
        placed: by a formula, or a table of two coordinates.
    """

    table: Table | None
    along: str = "x"
    file: FieldFile | None = None
    placed: Placed | None = None

    @property
    def uniform(self) -> float | None:
        """The temperature of a body that is equally warm throughout [°C], else None."""
        if self.table is None or not self.table.is_constant:
            return None
        return float(self.table.values[0])

    @property
    def bounds(self) -> tuple[float, float] | None:
        """Lowest and highest temperature [°C]; None for a file or a formula."""
        if isinstance(self.placed, PlacedTable):
            return float(self.placed.values.min()), float(self.placed.values.max())
        if self.table is None:
            return None
        return float(self.table.values.min()), float(self.table.values.max())

    @property
    def hottest(self) -> float:
        """Highest temperature [°C]; infinite for a file or a formula."""
        return math.inf if self.bounds is None else self.bounds[1]

    @property
    def is_missing(self) -> bool:
        """Whether nothing is given."""
        return self.table is None and self.file is None and self.placed is None

    @property
    def axes(self) -> tuple[str, ...]:
        """Coordinates along which it varies; () for a file."""
        if self.placed is not None:
            return self.placed.axes
        return () if self.table is None or self.table.is_constant else (self.along,)

    @property
    def text(self) -> str:
        """The temperature as a text for messages."""
        if self.file is not None:
            return f"{self.file.field} of {self.file.path.name}"
        if isinstance(self.placed, PlacedFormula):
            return f"{self.placed.text} °C"
        low, high = self.bounds or (math.nan, math.nan)
        along = " and ".join(self.axes)
        return f"{low:g} °C" if low == high else f"{low:g} to {high:g} °C along {along}"

    def relative_to(self, case: Path) -> InitialTemperature:
        """Return the same with an absolute path of its file, given relative to the case file."""
        if self.file is None:
            return self
        path = case.resolve().parent / self.file.path
        return replace(self, file=replace(self.file, path=path))

    def at(self, points: npt.ArrayLike) -> FloatArray:
        """Return the temperatures that are not in a file at points (n, gdim) [°C], shape (n,).

        Those of a formula may be none: not finite, or below absolute zero.
        """
        if self.placed is not None:
            return self.placed(points, 0.0)
        assert self.table is not None
        return np.asarray(self.table(coordinate(points, self.along)))


MISSING = InitialTemperature(None)


def read_initial_temperature(value: Any) -> InitialTemperature:
    """Return the temperature described by a number or a table of keys.

    These are { along, table }, { formula } or { file, field, unit }.

    Raises:
        Refusal: with the offending key.
    """
    if isinstance(value, InitialTemperature):
        return value
    if not isinstance(value, dict):
        return InitialTemperature(Table.constant(TEMPERATURES.read(value)))
    if "file" in value:
        return InitialTemperature(None, file=_field_file(value))
    if "formula" in value or isinstance(value.get("along"), list | tuple):
        return InitialTemperature(None, placed=Placing(TEMPERATURES).read(value))
    _check_keys(value, ("along", "table"), ("along", "table"))
    along = _choice(value, "along", AXES)
    try:
        table = Tabulated(TEMPERATURES, Quantity(LENGTH)).read(value["table"])
    except Refusal as error:
        raise error.inside("table") from None
    except CaseError as error:
        raise refuse(str(error), "table") from None
    return InitialTemperature(table, along)


def _field_file(value: Mapping[str, Any]) -> FieldFile:
    _check_keys(value, ("file", "field"), ("file", "field", "unit"))
    for key in ("file", "field"):
        text = value[key]
        if not isinstance(text, str) or not 0 < len(text) <= _LONGEST_NAME or "\0" in text:
            raise refuse(f"a text in quotes of 1 to {_LONGEST_NAME} characters is needed", key)
    path = Path(value["file"])
    if path.suffix.lower() not in SUFFIXES:
        raise refuse(f"a file of type {', '.join(SUFFIXES)} is needed", "file")
    unit = _choice(value, "unit", UNITS) if "unit" in value else "degC"
    return FieldFile(path, value["field"], unit)


def _check_keys(
    value: Mapping[str, Any], needed: tuple[str, ...], known: tuple[str, ...]
) -> None:
    for key in value:
        if key not in known:
            raise refuse(f"unknown key; {among(key, known, what='known keys')}", key)
    for key in needed:
        if key not in value:
            raise refuse(f"missing; {' and '.join(needed)} are needed", key)


def _choice(value: Mapping[str, Any], key: str, names: tuple[str, ...]) -> str:
    try:
        return Choice(names).read(value[key])
    except CaseError as error:
        raise refuse(str(error), key) from None
