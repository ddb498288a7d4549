"""Tables over time that grow by one line per accepted step."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Self

import numpy as np

from castx.arrays import FloatArray
from castx.results.files.folder import write_whole

if TYPE_CHECKING:
    from types import TracebackType


class Series:
    """A CSV file whose whole lines are on disk as soon as they are written.

    Numbers are written with all their digits, so that reading them gives the same bits.

    Args:
        path: the file; an older one is written over.
        columns: names in the header line.
        resumed: go on behind the lines that an older file has, which keep what they have of the
            columns.
    """

    def __init__(self, path: Path, columns: Sequence[str], *, resumed: bool = False) -> None:
        self._path, self._columns = path, tuple(columns)
        if resumed and path.exists():
            change_columns(path, self._columns)
            self._file = path.open("a", encoding="utf-8", newline="")
            self._writer = csv.writer(self._file, lineterminator="\n")
            return
        self._file = path.open("w", encoding="utf-8", newline="")
        self._writer = csv.writer(self._file, lineterminator="\n")
        self._write(self._columns)

    def append(self, row: Sequence[float]) -> None:
        """Write one line, in the order of the columns."""
        if len(row) != len(self._columns):
            raise ValueError(f"{self._file.name} has {len(self._columns)} columns, got {len(row)}")
        self._write(row)

    def _write(self, row: Sequence[float] | Sequence[str]) -> None:
        self._writer.writerow(row)
        self._file.flush()

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def cut_back(path: Path, rows: int) -> None:
    """Leave only the header and the first lines of a series, as far as it has them."""
    if not path.exists():
        return
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    whole = [line for line in lines if line.endswith("\n")]
    write_whole(path, "".join(whole[: rows + 1]))


def change_columns(path: Path, columns: Sequence[str]) -> None:
    """Change the columns of a CSV file; missing values are NaN."""
    with path.open(encoding="utf-8", newline="") as file:
        header, *rows = list(csv.reader(file)) or [[]]
    if header == list(columns):
        return
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        known = dict(zip(header, row, strict=False))
        writer.writerow([known.get(name, "nan") for name in columns])
    write_whole(path, text.getvalue())


def read_series(path: Path) -> dict[str, FloatArray]:
    """Return the columns of a series by name; a last line that was cut short is left out."""
    with path.open(encoding="utf-8", newline="") as file:
        header, *rows = list(csv.reader(file))
    values = np.array([row for row in rows if len(row) == len(header)], dtype=np.float64)
    columns = values.reshape(-1, len(header)).T
    return dict(zip(header, columns, strict=True))
