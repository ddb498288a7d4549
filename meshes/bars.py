"""Bars along x: one or two slabs over a common width and depth."""

from castx.arrays import FloatArray
from castx.meshes.grading import require_positive, uniform
from castx.meshes.linear_mesh import SIMPLICES, LinearMesh
from castx.meshes.model import Surface, plane
from castx.meshes.structured import grid, swept


def checked_depth(model: str, depth: float | None) -> float | None:
    """Return the depth of a body in space, None in a plane model.

    Raises:
        ValueError: a body in space has none, or it is not positive.
    """
    if model != "3d":
        return None
    if depth is None:
        raise ValueError('the model "3d" needs a depth')
    require_positive(depth=depth)
    return depth


def bars(x: FloatArray, width: float, depth: float | None, size: float, cells: str) -> LinearMesh:
    """Return a mesh of the bodies 0 (x > 0) and 1 (x < 0) over the width and depth.

    Args:
        x: grid lines [m].
        width: extent in y [m].
        depth: extent in z [m]; None in a plane model.
        size: element size across [m].
        cells: "simplices" or "quadrilaterals".
    """
    even = cells == SIMPLICES
    mesh = grid(x, uniform(width, size, even), lambda m: (m[:, 0] < 0).astype(int), cells)
    if depth is None:
        return mesh
    return swept(mesh, uniform(depth, size, even), lambda regions, z: regions)


def sides(width: float, depth: float | None, tolerance: float) -> list[Surface]:
    """Return the surfaces bottom, top and, in space, back and front.

    Args:
        width: extent in y [m].
        depth: extent in z [m]; None in a plane model.
        tolerance: of places [m].
    """
    found = [plane("bottom", 1, 0.0, tolerance), plane("top", 1, width, tolerance)]
    if depth is not None:
        found += [plane("back", 2, 0.0, tolerance), plane("front", 2, depth, tolerance)]
    return found
