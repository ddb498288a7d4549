"""Rectangles and boxes: a slab, two slabs face to face, one block on another."""

from collections.abc import Sequence

import numpy as np

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.meshes.grading import Sizing, graded, require_positive, uniform
from castx.meshes.linear_mesh import SIMPLICES, LinearMesh, checked_cells, mirrored
from castx.meshes.model import Surface, everything_else, fill_model, plane
from castx.meshes.structured import grid, swept


def slab(
    *,
    model: str,
    length: float,
    width: float,
    size: float,
    depth: float | None = None,
    interface_size: float | None = None,
    order_of_growth: float = 1.0,
    cells: str = SIMPLICES,
) -> None:
    """Mesh a casting in 0 <= x <= length, 0 <= y <= width (0 <= z <= depth).

    Surfaces: wall (x = 0), far (x = length), bottom (y = 0), top (y = width), in 3-D back (z = 0)
    and front (z = depth). An interface_size applies at the wall.

    Args:
        model: the case's model; "3d" needs a depth [m].
        length: extent in x [m].
        width: extent in y [m].
        size: element size [m].
        depth: extent in z [m].
        interface_size: element size at the wall [m].
        order_of_growth: exponent with which the size grows away from the wall.
        cells: "simplices" or "quadrilaterals" (hexahedra in 3-D).
    """
    checked_cells(cells)
    sizing = Sizing(size, interface_size, order_of_growth)
    require_positive(length=length, width=width)
    mesh = _bars(graded(length, sizing), width, _checked_depth(model, depth), size, cells)
    tolerance = 1e-8 * max(length, width)
    surfaces = [plane("wall", 0, 0.0, tolerance), plane("far", 0, length, tolerance)]
    fill_model(mesh, ["casting"], surfaces + _sides(width, depth, tolerance))


def two_slabs(
    *,
    model: str,
    length: float,
    mould_length: float,
    width: float,
    size: float,
    depth: float | None = None,
    interface_size: float | None = None,
    order_of_growth: float = 1.0,
    cells: str = SIMPLICES,
) -> None:
    """Mesh a casting in 0 <= x <= length that meets a mould in -mould_length <= x <= 0.

    Surfaces of both: far, bottom (y = 0), top (y = width), in 3-D back (z = 0), front (z = depth).

    Args:
        model: the case's model; "3d" needs a depth [m].
        length: extent of the casting in x [m].
        mould_length: extent of the mould in x [m].
        width: extent in y [m].
        size: element size [m].
        depth: extent in z [m].
        interface_size: element size at the interface [m].
        order_of_growth: exponent with which the size grows away from the interface.
        cells: "simplices" or "quadrilaterals" (hexahedra in 3-D).
    """
    checked_cells(cells)
    sizing = Sizing(size, interface_size, order_of_growth)
    require_positive(length=length, mould_length=mould_length, width=width)
    x = np.concatenate([-graded(mould_length, sizing)[:0:-1], graded(length, sizing)])
    mesh = _bars(x, width, _checked_depth(model, depth), size, cells)
    tolerance = 1e-8 * max(length, mould_length, width)
    surfaces = [plane("far", 0, -mould_length, tolerance), plane("far", 0, length, tolerance)]
    fill_model(mesh, ["casting", "mould"], surfaces + _sides(width, depth, tolerance))


def stacked_blocks(
    *,
    model: str,
    upper: Sequence[float],
    base: Sequence[float],
    size: float,
    symmetry: bool = True,
    interface_size: float | None = None,
    order_of_growth: float = 1.0,
    cells: str = SIMPLICES,
) -> None:
    """Mesh an upper block on a base of equal or greater width; they meet at height 0.

    The last coordinate points up; blocks are centred at x = 0 (and y = 0 in 3-D). Surfaces: upper:
    top, side; base: bottom, side, shelf (the free part of its top); with symmetry only x >= 0 (y >=
    0) is meshed, with symmetry-x (symmetry-y).

    Args:
        model: the case's model.
        upper: width, height (and depth, along y, in 3-D) of the upper block [m].
        base: the same of the base [m].
        size: element size [m].
        symmetry: mesh the half (quarter in 3-D) x >= 0 (y >= 0) only.
        interface_size: element size at the interface [m], in the direction of the height.
        order_of_growth: exponent with which the size grows away from the interface.
        cells: "simplices" or "quadrilaterals" (hexahedra in 3-D).
    """
    checked_cells(cells)
    sizing = Sizing(size, interface_size, order_of_growth)
    dim = 3 if model == "3d" else 2
    _check_blocks(upper, base, dim)
    if model == "axisymmetric" and not symmetry:
        raise ValueError("an axisymmetric mesh lies in x >= 0: set symmetry = true")
    heights = np.concatenate([-graded(base[1], sizing)[:0:-1], graded(upper[1], sizing)])
    x = _stepped(0.5 * upper[0], 0.5 * base[0], size)
    wide = 0.5 * upper[0]
    if dim == 2:
        mesh = grid(x, heights, lambda m: _block(m[:, 0] < wide, m[:, 1] > 0), cells)
        mesh = mesh if symmetry else mirrored(mesh, 0)
    else:
        y, deep = _stepped(0.5 * upper[2], 0.5 * base[2], size), 0.5 * upper[2]
        plan = grid(x, y, lambda m: ((m[:, 0] < wide) & (m[:, 1] < deep)).astype(int), cells)
        plan = plan if symmetry else mirrored(mirrored(plan, 0), 1)
        mesh = swept(plan, heights, lambda under, z: _block(under == 1, np.full(len(under), z > 0)))
    tolerance = 1e-8 * max(*upper, *base)
    surfaces = [plane(f"symmetry-{'xy'[a]}", a, 0.0, tolerance) for a in range(dim - 1) if symmetry]
    up = dim - 1
    surfaces += [plane("top", up, upper[1], tolerance), plane("bottom", up, -base[1], tolerance)]
    surfaces += [plane("shelf", up, 0.0, tolerance), everything_else("side")]
    fill_model(mesh, ["upper", "base"], surfaces)


def _check_blocks(upper: Sequence[float], base: Sequence[float], dim: int) -> None:
    for name, block in (("upper", upper), ("base", base)):
        if len(block) != dim:
            parts = "[width, height]" if dim == 2 else "[width, height, depth]"
            raise ValueError(f"{name} must be {parts}, got {len(block)} numbers")
        for length in block:
            require_positive(**{f"each length of {name}": length})
    for axis, what in ((0, "wide"), (2, "deep"))[: dim - 1]:
        if base[axis] < upper[axis] * (1 - 1e-9):
            raise ValueError(
                f"the base must be at least as {what} as the upper block, "
                f"got {base[axis]:g} m under {upper[axis]:g} m"
            )


def _block(under: BoolArray, above: BoolArray) -> LongArray:
    return np.where(above, np.where(under, 0, -1), 1)


def _stepped(inner: float, outer: float, size: float) -> FloatArray:
    """Return positions from 0 to `outer` with a node at `inner`."""
    positions = uniform(inner, size)
    if outer <= inner * (1 + 1e-9):
        return positions
    return np.concatenate([positions, inner + uniform(outer - inner, size)[1:]])


def _checked_depth(model: str, depth: float | None) -> float | None:
    if model != "3d":
        return None
    if depth is None:
        raise ValueError('the model "3d" needs a depth')
    require_positive(depth=depth)
    return depth


def _bars(x: FloatArray, width: float, depth: float | None, size: float, cells: str) -> LinearMesh:
    """Return a mesh of the bodies 0 (x > 0) and 1 (x < 0) over the width and depth."""
    even = cells == SIMPLICES
    mesh = grid(x, uniform(width, size, even), lambda m: (m[:, 0] < 0).astype(int), cells)
    if depth is None:
        return mesh
    return swept(mesh, uniform(depth, size, even), lambda regions, z: regions)


def _sides(width: float, depth: float | None, tolerance: float) -> list[Surface]:
    sides = [plane("bottom", 1, 0.0, tolerance), plane("top", 1, width, tolerance)]
    if depth is not None:
        sides += [plane("back", 2, 0.0, tolerance), plane("front", 2, depth, tolerance)]
    return sides
