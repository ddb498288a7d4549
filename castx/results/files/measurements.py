"""Measured curves beside those of the probes: read from a table of a logger, kept in the results.

The results folder holds a copy in SI units, measurements.csv, so that it stays whole when the file
of the logger is gone.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.case.output import DIMENSIONS
from castx.errors import CaseError
from castx.input.problems import among
from castx.input.units import ABSOLUTE_ZERO, TEMPERATURE, TIME, Dimension, number
from castx.ranks import on_first_rank
from castx.results.files.folder import MEASURED, write_whole

if TYPE_CHECKING:
    from castx.case.output import Measurement

LARGEST_FILE = 50_000_000  # bytes
SEPARATORS = (";", "\t", ",")
"""Of the columns, the first one that the heading has; except with commas, numbers may have them."""


@dataclass(frozen=True)
class Measured:
    """A measured curve.

    Attributes:
        time: since the start of the run, increasing [s], shape (points,).
        values: in the SI unit of the quantity, temperatures in °C, shape (points,).
    """

    time: FloatArray
    values: FloatArray


@dataclass(frozen=True)
class Deviation:
    """Deviation of a computed curve from a measured one, at measured moments within the run.

    Attributes:
        root_mean_square: of the differences.
        largest: computed minus measured where they differ most.
        at: when they do [s].
        points: number of moments that were compared.
    """

    root_mean_square: float
    largest: float
    at: float
    points: int


def deviation(time: FloatArray, computed: FloatArray, measured: Measured) -> Deviation | None:
    """Compare a computed curve, linear between its steps, with a measured one.

    Args:
        time: of the steps [s], shape (steps,).
        computed: there; not a number where there is nothing, such as a removed body.
        measured: the measured curve.

    Returns:
        None where no measured moment falls into the run.
    """
    known = np.isfinite(computed)
    inside = np.zeros(len(measured.time), dtype=bool)
    if known.any():
        first, last = time[known][[0, -1]]
        inside = (measured.time >= first) & (measured.time <= last)
    if not inside.any():
        return None
    at = measured.time[inside]
    apart = np.interp(at, time[known], computed[known]) - measured.values[inside]
    worst = int(np.argmax(np.abs(apart)))
    mean = float(np.sqrt(np.mean(apart**2)))
    return Deviation(mean, float(apart[worst]), float(at[worst]), len(at))


def measured_curves(
    measurements: Sequence[Measurement], columns: Collection[str], comm: MPI.Intracomm
) -> dict[str, Measured]:
    """Return measured curves by the column of probes.csv that they belong to; collective.

    Args:
        measurements: those of the case.
        columns: names of the columns of probes.csv.
        comm: the ranks.

    Raises:
        CaseError: a file cannot be read, or a measurement belongs to no column; on all ranks.
    """
    return on_first_rank(comm, lambda: {m.of: _checked(m, columns) for m in measurements})


def _checked(measurement: Measurement, columns: Collection[str]) -> Measured:
    if measurement.of not in columns:
        known = among(measurement.of, list(columns), what="what the probes record")
        raise CaseError(f"measurement of {measurement.of!r}: no probe records it; {known}")
    return read_measurement(measurement)


def read_measurement(measurement: Measurement) -> Measured:
    """Return a measured curve from the file of a case, in SI units and the time of the run.

    Raises:
        CaseError: the file or a column is missing, or holds no increasing times with numbers.
    """
    where = f"measurement of {measurement.of!r}: {measurement.file}"
    quantity = measurement.of.split(".")[1]
    try:
        rows = _rows(measurement, _text(measurement.file))
        time, values = np.array(list(rows), dtype=np.float64).reshape(-1, 2).T
        time = _in_si(time, measurement.time_unit, TIME) - measurement.start
        values = _in_si(values, measurement.unit, DIMENSIONS[quantity])
    except CaseError as error:
        raise CaseError(f"{where}: {error}") from None
    if not len(time):
        raise CaseError(f"{where}: there is no line with a time and a number")
    if DIMENSIONS[quantity] is TEMPERATURE and values.min() < ABSOLUTE_ZERO:
        coldest = int(values.argmin())
        raise CaseError(
            f"{where}: {values[coldest]:g} °C at {time[coldest]:g} s of the run is below absolute "
            "zero; correct unit or column"
        )
    if np.any(np.diff(time) <= 0.0):
        late = time[int(np.argmax(np.diff(time) <= 0.0))]
        raise CaseError(f"{where}: times must increase, and do not behind {late:g} s of the run")
    return Measured(time, values)


def _text(path: Path) -> str:
    try:
        if not path.is_file():
            raise CaseError("there is no such file")
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except OSError as error:
        raise CaseError(f"cannot be read: {error.strerror}") from None
    if len(content) > LARGEST_FILE:
        raise CaseError(f"too large; at most {LARGEST_FILE} bytes are read")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise CaseError(f"not a text in UTF-8 (byte {error.start})") from None


def _rows(measurement: Measurement, text: str) -> Iterator[tuple[float, float]]:
    """Yield time and value of each line that has both."""
    heading = text.partition("\n")[0]
    separator = next((mark for mark in SEPARATORS if mark in heading), ",")
    try:
        lines = list(csv.reader(io.StringIO(text), delimiter=separator))
    except csv.Error as error:
        raise CaseError(f"not a table: {error}") from None
    names = [name.strip() for name in lines[0]] if lines else []
    chosen = (measurement.time, measurement.column or measurement.of)
    for name in chosen:
        if name not in names:
            raise CaseError(f"no column {name!r}; {among(name, names)}")
    places = [names.index(name) for name in chosen]
    for line_number, line in enumerate(lines[1:], start=2):
        cells = [line[place].strip() if place < len(line) else "" for place in places]
        if all(cells):
            first, second = (_number(cell, separator, line_number) for cell in cells)
            yield first, second


def _number(cell: str, separator: str, line: int) -> float:
    text = cell.replace(",", ".") if separator != "," else cell
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise CaseError(f"line {line}: {cell!r} is no number")
    return value


def _in_si(values: FloatArray, unit: str, dimension: Dimension) -> FloatArray:
    """Convert values from a unit to the unit of a dimension; an empty text means the latter."""
    if not unit:
        return values
    # Conversions are linear: two numbers fix them. Zero kelvins are as cold as anything may be.
    low, high = (number(f"{at} {unit}", dimension) for at in (300, 400))
    return np.asarray(low + (values - 300.0) * (high - low) / 100.0)


def write_measured(folder: Path, curves: Mapping[str, Measured]) -> None:
    """Write measured curves into a results folder; none leave no file.

    Args:
        folder: the results folder.
        curves: by the column of probes.csv.
    """
    if not curves:
        (folder / MEASURED).unlink(missing_ok=True)
        return
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("of", "time", "value"))
    for name, curve in curves.items():
        points = zip(curve.time, curve.values, strict=True)
        writer.writerows((name, float(time), float(value)) for time, value in points)
    write_whole(folder / MEASURED, text.getvalue())


def read_measured(folder: Path) -> dict[str, Measured]:
    """Return the measured curves of a results folder by the column of probes.csv.

    Raises:
        ValueError: the table is damaged.
    """
    try:
        with (folder / MEASURED).open(encoding="utf-8", newline="") as file:
            lines = list(csv.reader(file))[1:]
    except FileNotFoundError:
        return {}
    points: dict[str, list[tuple[float, float]]] = {}
    for name, time, value in lines:
        points.setdefault(name, []).append((float(time), float(value)))
    return {name: Measured(*np.array(of).T) for name, of in points.items()}
