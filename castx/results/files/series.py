"""Tables over time that grow by one line per accepted step."""

from __future__ import annotations

import csv
import io
import logging
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Self, TextIO

import numpy as np

from castx.arrays import FloatArray
from castx.results.files.folder import write_whole

if TYPE_CHECKING:
    from types import TracebackType


log = logging.getLogger(__name__)


class Series:
    """A CSV file whose whole lines can be read as soon as they are written.

    It is made anew with all its lines when somebody removes or replaces it meanwhile; one that is
    cut short goes on with the whole lines that are left, and says how many are lost. Numbers are
    written with all their digits, so that reading them gives the same bits.

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
            self._open("a+")
            return
        self._open("w+")
        self._write(self._columns)

    def _open(self, mode: str) -> None:
        self._file = self._path.open(mode, encoding="utf-8", newline="")
        self._size = os.fstat(self._file.fileno()).st_size
        self._writer = csv.writer(self._file, lineterminator="\n")

    def append(self, row: Sequence[float]) -> None:
        """Write a row, in the order of the columns."""
        if len(row) != len(self._columns):
            raise ValueError(f"{self._file.name} has {len(self._columns)} columns, got {len(row)}")
        self._write(row)

    def _write(self, row: Sequence[float] | Sequence[str]) -> None:
        self._mend()
        self._writer.writerow(row)
        self._file.flush()
        self._size = os.fstat(self._file.fileno()).st_size
        self._keep()

    def _mend(self) -> None:
        """Go on with whole lines after somebody has cut the file short."""
        size = os.fstat(self._file.fileno()).st_size
        if size >= self._size:
            return
        self._file.seek(0)
        lines = [line for line in self._file.read().splitlines(keepends=True) if line[-1] == "\n"]
        heading = io.StringIO()
        csv.writer(heading, lineterminator="\n").writerow(self._columns)
        write_whole(self._path, "".join([heading.getvalue(), *lines[1:]]))
        self._file.close()
        self._open("a+")
        log.warning(
            "%s was cut short during the run: of its last lines %d bytes are lost",
            self._path, self._size - size,
        )  # fmt: skip

    def _keep(self) -> None:
        """Write the file anew if its name no longer leads to it."""
        try:
            if os.path.samestat(os.fstat(self._file.fileno()), self._path.stat()):
                return
        except FileNotFoundError:
            pass
        self._file.seek(0)
        write_whole(self._path, self._file.read())
        self._file.close()
        self._open("a+")
        log.warning("%s was removed or replaced during the run; it is written anew", self._path)

    def sync(self) -> None:
        """Bring all lines to disk."""
        self._keep()
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Close the file."""
        if not self._file.closed:
            try:
                self._keep()
                self._mend()
            finally:
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


def damage_of(path: Path, rows: int, time: float) -> str | None:
    """Return the fault in the first lines of a series, None if rows can be appended.

    Args:
        path: the file.
        rows: number of lines behind the header that it must have.
        time: in the last of them [s].
    """
    try:
        with _opened(path) as file:
            header, *lines = list(csv.reader(file)) or [[]]
        kept = np.array(lines[:rows], dtype=np.float64).reshape(-1, max(len(header), 1))
    except (OSError, ValueError, csv.Error) as error:
        return f"it is no table of numbers: {error}"
    if header[:1] != ["time"]:
        return "its first column is not time"
    if len(kept) < rows:
        return f"it has {len(kept)} lines, and {rows} were written before the checkpoint"
    times = kept[:, 0]
    back = not_later(times)
    if back is not None:
        return f"line {back} does not come after the one before it in time"
    if rows and times[-1] != time:
        return f"its line {rows + 1} is of t = {times[-1]:g} s, the checkpoint of {time:g} s"
    return None


def _opened(path: Path) -> TextIO:
    if path.exists() and not path.is_file():  # nobody may ever write into a pipe
        raise OSError(f"{path.name} is no regular file")
    return path.open(encoding="utf-8", newline="")


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
    """Return the columns of a series by name; a last line that was cut short is left out.

    Raises:
        OSError, ValueError: it cannot be read, is no table of numbers, or does not go on in time.
    """
    try:
        with _opened(path) as file:
            header, *rows = list(csv.reader(file)) or [[]]
    except csv.Error as error:
        raise ValueError(f"{path.name}: {error}") from None
    if not header or len(set(header)) < len(header):
        raise ValueError(f"{path.name}: a line with the names of the columns, each once, is needed")
    for number, row in enumerate(rows[:-1], 2):
        if len(row) != len(header):
            raise ValueError(
                f"{path.name}: line {number} has {len(row)} entries for {len(header)} columns"
            )
    values = np.array([row for row in rows if len(row) == len(header)], dtype=np.float64)
    columns = dict(zip(header, values.reshape(-1, len(header)).T, strict=True))
    back = not_later(columns["time"]) if "time" in columns else None
    if back is not None:
        raise ValueError(f"{path.name}: line {back} does not come after the one before it in time")
    return columns


def not_later(times: FloatArray) -> int | None:
    """Return the number of the first line whose time is not after that of the one before it.

    Args:
        times: of the lines behind the header, which is line 1 [s].
    """
    back = np.flatnonzero(~(np.diff(times) > 0.0) | ~np.isfinite(times[1:]))
    return int(back[0]) + 3 if back.size else None
