"""One block on another."""

from collections.abc import Iterator, Sequence

import numpy as np

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.meshes.generators.declaration import (
    MODELS,
    SIDES,
    SYMMETRY_PLANES,
    YES_OR_NO,
    Arguments,
    Generator,
)
from castx.meshes.grading import Sizing, graded, require_positive, uniform
from castx.meshes.linear_mesh import SIMPLICES, checked_cells, mirrored
from castx.meshes.model import everything_else, fill_model, plane, symmetry_plane
from castx.meshes.modulus import block_modulus, ring_modulus
from castx.meshes.structured import grid, swept


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
    surfaces = [plane(symmetry_plane(a), a, 0.0, tolerance) for a in range(dim - 1) if symmetry]
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


def _problems(arguments: Arguments, model: str) -> Iterator[tuple[str, str]]:
    upper, base = arguments["upper"], arguments["base"]
    dimension = 3 if model == "3d" else 2
    for name, sides in (("upper", upper), ("base", base)):
        if len(sides) != dimension:
            yield name, f"the model {model!r} needs {dimension} lengths"
    for index, what in ((0, "wide"), (2, "deep")):
        if len(upper) == len(base) > index and upper[index] > base[index] * (1.0 + 1e-9):
            yield "upper", f"the base must be at least as {what} as the upper block"
    if model == "axisymmetric" and not arguments.get("symmetry", True):
        yield "symmetry", "an axisymmetric mesh lies in r >= 0; leave it true"


def _moduli(arguments: Arguments, model: str) -> dict[str, float]:
    sides = {name: arguments[name] for name in ("upper", "base")}
    if model == "axisymmetric":
        return {name: ring_modulus(0.0, 0.5 * w, height) for name, (w, height) in sides.items()}
    return {name: block_modulus(found) for name, found in sides.items()}


GENERATOR = Generator(
    mesh=stacked_blocks,
    summary="A block on a base that is at least as wide; they meet at height 0.",
    models=MODELS,
    arguments={
        "upper": SIDES.of("[width, height, (depth)] of the block", (0.06, 0.04, 0.05)),
        "base": SIDES.of("the same of the base", (0.1, 0.03, 0.08)),
        "symmetry": YES_OR_NO.of("only x ≥ 0 (and y ≥ 0) is meshed", True),
    },
    surfaces={
        "upper": ("top", "side", *SYMMETRY_PLANES),
        "base": ("bottom", "side", "shelf", *SYMMETRY_PLANES),
    },
    extents=lambda a: [a["base"][0], a["base"][1] + a["upper"][1], *a["base"][2:]],
    moduli=_moduli,
    problems=_problems,
)
