"""Polygons of a scene as triangles that a page draws."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray


def triangulated(polygons: FloatArray) -> FloatArray:
    """Return triangles or quadrilaterals as triangles, those of one behind each other.

    Args:
        polygons: (polygons, 3 or 4 corners in an order that goes round, 3).

    Returns:
        (triangles, 3 corners, 3).
    """
    count = polygons.shape[1]
    corners = np.array([[0, k, k + 1] for k in range(1, count - 1)])
    return polygons[:, corners].reshape(-1, 3, 3)
