"""Tables over time that grow by one line per accepted step."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Self

import numpy as np

from castx.tables import FloatArray

if TYPE_CHECKING:
    from types import TracebackType


class Series:
    """A CSV file whose whole lines are on disk as soon as they are written.

    Numbers are written with all their digits, so that reading them gives the same bits.

    Args:
        path: the file; an older one is written over.
        columns: names in the header line.
    """

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        self._columns = tuple(columns)
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


def read_series(path: Path) -> dict[str, FloatArray]:
    """Return the columns of a series by name; a last line that was cut short is left out."""
    with path.open(encoding="utf-8", newline="") as file:
        header, *rows = list(csv.reader(file))
    values = np.array([row for row in rows if len(row) == len(header)], dtype=np.float64)
    columns = values.reshape(-1, len(header)).T
    return dict(zip(header, columns, strict=True))
