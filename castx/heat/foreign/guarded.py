"""Fields of other programs at points, read in a process of its own with limits."""

from __future__ import annotations

import io
import json
from dataclasses import dataclass
from pathlib import Path
from subprocess import TimeoutExpired
from tempfile import TemporaryFile

import numpy as np

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.input.child_process import REFUSED, end_of, run_apart, shortened
from castx.input.problems import among

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
        path: an existing VTU, XDMF or VTKHDF file.
        field: name of the field.
        points: shape (points, gdim) [m].

    Raises:
        CaseError: the file cannot be read within the limits, or not be used.
    """
    patience = PATIENCE + size_of(path) / SPEED + len(points) / POINTS_A_SECOND
    request = {"path": str(path), "field": field, "refused": REFUSED}
    request |= {"memory": MEMORY, "unpacked": UNPACKED}
    script = str(Path(__file__).with_name("child.py"))
    try:
        with TemporaryFile() as places:
            np.save(places, np.ascontiguousarray(points, dtype=np.float64))
            places.seek(0)
            ended = run_apart([script, json.dumps(request)], patience, given=places)
    except TimeoutExpired:
        raise CaseError(f"{path} cannot be read: it took more than {patience:.0f} s") from None
    if ended.returncode == 0:
        with np.load(io.BytesIO(ended.stdout), allow_pickle=False) as arrays:
            return Interpolated(arrays["values"], arrays["distances"], arrays["sizes"])
    if ended.returncode == REFUSED:
        raise CaseError(f"{path}{refusal_of(ended.stdout.decode(errors='replace'))}")
    raise CaseError(
        f"{path} cannot be read: {end_of('reader', ended.returncode, ended.stderr)}; it is "
        f"damaged, or needs more memory than {MEMORY / 1024**2:.0f} MB and {UNPACKED} times its "
        "size: write it again, with less compression"
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
