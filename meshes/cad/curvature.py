"""Sizes of cells on curved faces, and how many cells they make."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import gmsh
import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.meshes.cad.description import MILLIMETRES, CadPart
from castx.meshes.cad.faces import Face, inner_parameters

FILLING = 0.11
"""Volume of a cell over the cube of its size."""


def curved_sizes(tag: int, parameters: FloatArray, count: float) -> FloatArray:
    """Return the sizes at points of a face of which `count` go round its circle of curvature.

    Args:
        tag: of the face.
        parameters: of the points, flat: to find them of points beside a face takes milliseconds.
        count: of cells.
    """
    if not len(parameters):
        return np.empty(0)
    bounds = gmsh.model.getPrincipalCurvatures(tag, parameters)[:2]
    curvature = np.abs(np.array(bounds)).max(axis=0) * MILLIMETRES
    return np.asarray(2.0 * pi / count / np.maximum(curvature, 1e-9))


def curved_triangles(tag: int, nodes: LongArray, count: float) -> FloatArray:
    """Return the sizes at the triangles of a meshed face: of those at their corners the middle one.

    A corner may be the tip of a cone, where sizes are as small as they like.

    Args:
        tag: of the face.
        nodes: of its triangles, (triangles, 3).
        count: of cells round a circle of curvature.
    """
    tags, _, parameters = gmsh.model.mesh.getNodes(2, tag, True, True)
    order = np.argsort(tags)
    sizes = curved_sizes(tag, parameters, count)[order]
    return np.asarray(np.median(sizes[np.searchsorted(tags[order], nodes)], axis=1))


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
        sizes = curved_sizes(face.tag, inner_parameters(face.tag), part.curvature)
        size = min(float(np.median(sizes)), part.size)
        cells += face.area * (size**-2 - part.size**-2) / (2.0 * part.growth) / FILLING
        if size < least:
            least, place = size, face.points[len(face.points) // 2]
    return cells, least, place
