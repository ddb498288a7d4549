"""The shape of a casting without its pipe, from the fields of a run.

The field `emptied`, e, says which share of each node has flowed out, so that the volume of the pipe
is ∫ e. Cut off is what lies beyond the surface e = c on which both volumes are the same,

    |{e > c}| = ∫ e  over the body;

there is one, since ∫ e is the mean of |{e > c}| over c from 0 to 1. Triangles and tetrahedra are
cut exactly; other cells are divided into them.
"""

from __future__ import annotations

import numpy as np
import pyvista
from scipy.optimize import brentq

from castx.arrays import FloatArray
from castx.case.fields.feeding import EMPTIED
from castx.domain.cell_kinds import linear_means
from castx.results.reading import cells_of

LEAST = 1e-9
"""Share of a body below which its pipe is none."""
CLOSE = 1e-12
"""Error of c."""


def pipe_level(grid: pyvista.UnstructuredGrid, model: str) -> float | None:
    """Return c of a body, beyond which its pipe is cut off; None where nothing has flowed out.

    Args:
        grid: the body with its fields, not displaced.
        model: geometric model.
    """
    if EMPTIED not in grid.point_data or not np.any(grid[EMPTIED] > 0.0):
        return None
    simple = simplices(grid)
    cells, emptied = cells_of(simple), np.asarray(simple[EMPTIED], dtype=np.float64)
    points = np.asarray(simple.points, dtype=np.float64)
    volumes = measured(points[cells], model)
    share = float(volumes @ linear_means(points[cells], emptied[cells], model))
    if share <= LEAST * volumes.sum():
        return None
    ends = emptied[cells].min(axis=1), emptied[cells].max(axis=1)

    def beyond(level: float) -> float:
        """Return by how much |{e > c}| is too large."""
        whole = float(volumes[ends[0] >= level].sum())
        through = np.flatnonzero((ends[0] < level) & (ends[1] > level))
        if not len(through):
            return whole - share
        part = simplices(
            simple.extract_cells(through).clip_scalar(scalars=EMPTIED, invert=False, value=level)
        )
        corners = np.asarray(part.points, dtype=np.float64)[cells_of(part)]
        return whole + float(measured(corners, model).sum()) - share

    return float(brentq(beyond, CLOSE, float(emptied.max()), xtol=CLOSE))


def without_pipe(grid: pyvista.UnstructuredGrid, model: str) -> pyvista.UnstructuredGrid:
    """Return the rest of a body; the body itself where nothing has flowed out.

    Args:
        grid: the body with its fields, not displaced.
        model: geometric model.
    """
    level = pipe_level(grid, model)
    if level is None:
        return grid
    left: pyvista.UnstructuredGrid = grid.clip_scalar(scalars=EMPTIED, invert=True, value=level)
    return left


def drawn_body(grid: pyvista.UnstructuredGrid, model: str, field: str) -> pyvista.UnstructuredGrid:
    """Return a body as a picture of a field has it: whole where the pipe itself is shown.

    Args:
        grid: as above.
        model: geometric model.
        field: name of the field.
    """
    return grid if field == EMPTIED else without_pipe(grid, model)


def simplices(grid: pyvista.UnstructuredGrid) -> pyvista.UnstructuredGrid:
    """Return a body of triangles or tetrahedra, other cells divided into them."""
    simple = (pyvista.CellType.TRIANGLE, pyvista.CellType.TETRA)
    if np.isin(grid.celltypes, simple).all():
        return grid
    divided: pyvista.UnstructuredGrid = grid.triangulate()
    return divided


def measured(corners: FloatArray, model: str) -> FloatArray:
    """Return the volumes of simplices [m³], per metre in plane models, (cells,).

    Args:
        corners: their points, (cells, corners, 3) [m].
        model: geometric model; of an axisymmetric one it is that of the full turn.
    """
    edges = corners[:, 1:] - corners[:, :1]
    if corners.shape[1] == 4:
        return np.asarray(np.abs(np.linalg.det(edges)) / 6.0)
    areas = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    if model == "axisymmetric":
        return np.asarray(2.0 * np.pi * corners[:, :, 0].mean(axis=1) * areas)
    return np.asarray(areas)
