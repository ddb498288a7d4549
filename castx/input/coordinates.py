"""Coordinates along which the numbers of a case may vary."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from castx.arrays import FloatArray

AXES = ("x", "y", "z", "r")


def coordinate(points: npt.ArrayLike, axis: str) -> FloatArray:
    """Return one coordinate of points [m], shape (n,).

    Args:
        points: shape (n, gdim) [m].
        axis: one of `AXES`. In models of two coordinates x and r are the first, y and z the second;
            in space r is the distance from the z axis.
    """
    places = np.asarray(points, dtype=np.float64)
    if axis == "r" and places.shape[1] == 3:
        return np.asarray(np.hypot(places[:, 0], places[:, 1]))
    return places[:, {"x": 0, "r": 0, "y": 1, "z": -1}[axis]]
