"""Sizes of cells on curved faces, and how many cells they make."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import gmsh
import numpy as np

from castx.arrays import FloatArray
from castx.meshes.cad.description import MILLIMETRES, CadPart
from castx.meshes.cad.faces import Face

FILLING = 0.11
"""Volume of a cell over the cube of its size."""


def curved_sizes(tag: int, points: FloatArray, count: float) -> FloatArray:
    """Return the sizes at points of a face of which `count` go round its circle of curvature."""
    if not len(points):
        return np.empty(0)
    parameters = gmsh.model.getParametrization(2, tag, (MILLIMETRES * points).ravel())
    bounds = gmsh.model.getPrincipalCurvatures(tag, parameters)[:2]
    curvature = np.abs(np.array(bounds)).max(axis=0) * MILLIMETRES
    return np.asarray(2.0 * pi / count / np.maximum(curvature, 1e-9))


def curved_cells(part: CadPart, faces: Sequence[Face]) -> tuple[float, float, FloatArray]:
    """Return the cells that curved faces ask for, before anything is meshed.

    Of a face counts the median of its sizes: at the tip of a cone alone it is as small as it likes.

    Args:
        part: what is meshed.
        faces: of the model.

    Returns:
        Number of cells behind them, the smallest size [m], and the middle of its face (3,) [m].
    """
    cells, least, place = 0.0, part.size, np.zeros(3)
    for face in faces:
        sizes = curved_sizes(face.tag, face.points, part.curvature)
        size = min(float(np.median(sizes)), part.size)
        cells += face.area * (size**-2 - part.size**-2) / (2.0 * part.growth) / FILLING
        if size < least:
            least, place = size, face.points[len(face.points) // 2]
    return cells, least, place
