"""Temperatures from files of other programs, interpolated at given points; on one rank."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from castx.arrays import FloatArray
from castx.case.initial_temperature import FieldFile
from castx.errors import CaseError
from castx.heat.foreign.guarded import interpolated
from castx.input.units import TEMPERATURE, number

LARGEST_FILE = 4 * 1024**3
"""Bytes of a file that is still read."""


def temperatures_at(file: FieldFile, points: FloatArray) -> FloatArray:
    """Return the temperatures of a file at points [°C].

    They are interpolated in the cell that contains the point, as VTK does for its kind: linearly in
    simplices. A point outside by less than the size of the nearest cell takes the temperature of
    the nearest point of that cell. Plane models read the plane in which the file lies.

    Args:
        file: the file and its field.
        points: shape (points, gdim) [m].

    Raises:
        CaseError: the file cannot be read, lacks the field or its cells, has no temperatures, or
            a point lies farther out.
    """
    _check_file(file.path)
    found = interpolated(file.path, file.field, points)
    outside = found.distances > found.sizes
    if outside.any():
        k = int(np.argmax(found.distances - found.sizes))
        place = ", ".join(f"{value:g}" for value in points[k])
        raise CaseError(
            f"{file.path}: its mesh ends {found.distances[k]:.3g} m short of ({place}) m, more "
            f"than the size of a cell; {np.count_nonzero(outside)} of {len(points)} nodes lie so "
            "far out (is the file in m?)"
        )
    return _in_degrees(found.values, file)


def _check_file(path: Path) -> None:
    if not path.is_file():
        raise CaseError(f"there is no file {path}")
    if path.stat().st_size > LARGEST_FILE:
        raise CaseError(f"{path}: larger than {LARGEST_FILE / 1024**3:g} GiB")


def _in_degrees(values: FloatArray, file: FieldFile) -> FloatArray:
    zero, thousand = (number(f"{value} {file.unit}", TEMPERATURE) for value in (0, 1000))
    celsius = zero + (thousand - zero) / 1000.0 * values
    try:
        number(float(celsius.min()), TEMPERATURE)
    except CaseError as error:
        raise CaseError(f"{file.path}: the field {file.field!r} goes {error}") from None
    return np.asarray(celsius)
