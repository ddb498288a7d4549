"""Fields of other programs at points, read in a process of its own with limits."""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile

import numpy as np

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.input.printable import printable
from castx.input.problems import among

REFUSED = 3
"""Exit code of the reader after a refusal in words."""
MEMORY = 200 * 1024**2
"""Memory that reading may take [bytes], beside that for the size of the file."""
UNPACKED = 40
"""Memory that it may take for each byte of the file: fields in double precision, compressed, with
what VTK needs to find cells, take about 12."""
PATIENCE = 60.0
"""Time that reading may take [s], beside that for the size of the file and the points."""
SPEED = 5e6
"""Bytes a second that are read at least."""
POINTS_A_SECOND = 1000.0
"""Points a second that are found at least."""
SHOWN = 300
"""Characters of what a reader has said that are shown."""
OF_MPI = ("OMPI_", "PMIX_", "PRTE_", "PMI_")
"""Beginnings of the variables by which a process takes itself for a rank."""


@dataclass(frozen=True)
class Interpolated:
    """Values at points, and how far from the cells of the file they were taken.

    Args:
        values: shape (points,).
        distances: of the points from the nearest cell, zero inside [m].
        sizes: diameter of that cell [m].
    """

    values: FloatArray
    distances: FloatArray
    sizes: FloatArray


def interpolated(path: Path, field: str, points: FloatArray) -> Interpolated:
    """Return a field of a file at points, interpolated in its cells.

    Args:
        path: an existing VTU or XDMF file.
        field: name of the field.
        points: shape (points, gdim) [m].

    Raises:
        CaseError: the file cannot be read within the limits, or not be used.
    """
    patience = PATIENCE + size_of(path) / SPEED + len(points) / POINTS_A_SECOND
    request = {"path": str(path), "field": field, "refused": REFUSED}
    request |= {"memory": MEMORY, "unpacked": UNPACKED}
    script = str(Path(__file__).with_name("child.py"))
    kept = {key: value for key, value in os.environ.items() if not key.startswith(OF_MPI)}
    try:
        # A file and no pipe: PETSc ends a process that writes to a reader which has died.
        with TemporaryFile() as places:
            np.save(places, np.ascontiguousarray(points, dtype=np.float64))
            places.seek(0)
            ended = subprocess.run(
                [sys.executable, "-P", script, json.dumps(request)],
                stdin=places, capture_output=True, env=kept | {"OPENBLAS_NUM_THREADS": "1"},
                timeout=patience, check=False,
            )  # fmt: skip
    except subprocess.TimeoutExpired:
        raise CaseError(f"{path} cannot be read: it took more than {patience:.0f} s") from None
    if ended.returncode == 0:
        with np.load(io.BytesIO(ended.stdout), allow_pickle=False) as arrays:
            return Interpolated(arrays["values"], arrays["distances"], arrays["sizes"])
    if ended.returncode == REFUSED:
        raise CaseError(f"{path}{refusal_of(ended.stdout.decode(errors='replace'))}")
    raise CaseError(
        f"{path} cannot be read: {end_of(ended.returncode, ended.stderr)}; it is damaged, or needs "
        f"more memory than {MEMORY / 1024**2:.0f} MB and {UNPACKED} times its size: write it "
        "again, with less compression"
    )


def size_of(path: Path) -> int:
    """Return the size of a file and its companions of one stem (case.xdmf, case.h5) [bytes]."""
    return sum(
        file.stat().st_size
        for file in path.parent.iterdir()
        if file.name.startswith(path.stem) and file.is_file()
    )


def refusal_of(text: str) -> str:
    """Return the reason of a refusal; for a missing field, with the names of the known fields."""
    try:
        found = json.loads(text.removeprefix(": "))
        missing = among(found["field"], found["known"], what="it has")
        return f": no field {found['field']!r}; {missing}"
    except (ValueError, TypeError, LookupError):
        return shortened(text)


def end_of(code: int, errors: bytes) -> str:
    """Return a text on the end of a reader."""
    lines = [line for line in errors.decode(errors="replace").splitlines() if line.strip()]
    last = shortened(lines[-1]) if lines else "no word"
    how = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
    return f"its reader ended {how} ({last})"


def shortened(text: str) -> str:
    """Return a text of a reader as one line of limited length."""
    line = printable(text.replace("\n", " "))
    return line if len(line) <= SHOWN else f"{line[:SHOWN]} ..."
