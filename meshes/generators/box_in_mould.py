"""A box in a mould."""

from collections.abc import Iterator, Sequence

import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.meshes.generators.declaration import (
    LENGTH,
    PLANE_MODELS,
    SIDES,
    YES_OR_NO,
    Arguments,
    Generator,
)
from castx.meshes.grading import (
    Sizing,
    between_walls,
    graded,
    graded_through,
    require_positive,
)
from castx.meshes.linear_mesh import SIMPLICES, checked_cells, mirrored
from castx.meshes.model import base_top_and_outside, fill_model
from castx.meshes.modulus import block_modulus
from castx.meshes.structured import grid, swept

CASTING, MOULD = 0, 1


def box_in_mould(
    *,
    model: str,
    box: Sequence[float],
    wall: float,
    size: float,
    lid: bool = False,
    interface_size: float | None = None,
    order_of_growth: float = 1.0,
    cells: str = SIMPLICES,
) -> None:
    """Mesh a box in a mould that is as thick below as on the sides, and with a lid also above.

    The last coordinate points up; the casting is centred at x = 0 (and y = 0 in 3-D) and stands at
    height 0. The mesh is its own mirror image in x = 0 (and y = 0). Surfaces: casting: top, without
    a lid; mould: outside (its sides), base (its lowest face), top (its highest one).

    Args:
        model: a plane model or "3d".
        box: width, height (and depth, along y, in 3-D) of the casting [m].
        wall: thickness of the mould [m].
        size: element size [m].
        lid: close the mould with a lid of the same thickness.
        interface_size: element size at the interface [m].
        order_of_growth: exponent with which the size grows away from the interface.
        cells: "simplices" or "quadrilaterals" (hexahedra in 3-D).
    """
    checked_cells(cells)
    sizing = Sizing(size, interface_size, order_of_growth)
    _check(model, box, wall)
    half = [0.5 * length for length in (box[0], *box[2:])]
    levels = _levels(box[1], wall, lid, sizing)
    x = _from_the_middle(half[0], wall, sizing)
    if model == "3d":
        y = _from_the_middle(half[1], wall, sizing)
        corner = _line(x, half[0]), _line(y, half[1])
        plan = grid(x, y, lambda m: np.where((m > half).any(axis=1), MOULD, CASTING), cells, corner)
        mesh = swept(
            mirrored(mirrored(plan, 0), 1),
            levels,
            lambda body, z: body if 0 < z < box[1] else np.full_like(body, MOULD),
            _line(levels, 0.0),
        )
    else:
        corner = _line(x, half[0]), _line(levels, 0.0)
        right = grid(x, levels, lambda m: _body(m, half[0], box[1]), cells, corner)
        mesh = mirrored(right, 0)
    tolerance = 1e-8 * (max(box) + wall)
    up = mesh.dimension - 1
    fill_model(mesh, ["casting", "mould"], base_top_and_outside(up, levels, tolerance))


def _check(model: str, box: Sequence[float], wall: float) -> None:
    if model == "axisymmetric":
        raise ValueError("a box has corners; the axisymmetric generator is cylinder_in_mould")
    if len(box) != (3 if model == "3d" else 2):
        parts = "[width, height, depth]" if model == "3d" else "[width, height]"
        raise ValueError(f"box must be {parts}, got {len(box)} numbers")
    for length in box:
        require_positive(**{"each length of box": length})
    require_positive(wall=wall)


def _from_the_middle(half: float, wall: float, sizing: Sizing) -> FloatArray:
    """Return positions from the middle of the casting to the outside of the mould."""
    inside = half - graded(half, sizing)[::-1]
    inside[0] = 0.0
    return np.concatenate([inside, half + graded(wall, sizing)[1:]])


def _levels(height: float, wall: float, lid: bool, sizing: Sizing) -> FloatArray:
    outside = graded(wall, sizing)
    if lid:
        return between_walls(graded_through(np.array([0.0, height]), sizing), outside)
    return np.concatenate([-outside[:0:-1], graded(height, sizing)])


def _line(positions: FloatArray, value: float) -> int:
    """Return the number of the grid line at a position."""
    return int(np.abs(positions - value).argmin())


def _body(middle: FloatArray, half: float, height: float) -> LongArray:
    outside = (middle[:, 0] > half) | (middle[:, 1] < 0) | (middle[:, 1] > height)
    return np.where(outside, MOULD, CASTING)


def _problems(arguments: Arguments, model: str) -> Iterator[tuple[str, str]]:
    dimension = 3 if model == "3d" else 2
    if len(arguments["box"]) != dimension:
        yield "box", f"the model {model!r} needs {dimension} lengths"


def _extents(arguments: Arguments) -> list[float]:
    width, height, *depth = arguments["box"]
    walls = 2 * arguments["wall"]
    above = walls if arguments.get("lid", False) else arguments["wall"]
    return [width + walls, height + above, *(side + walls for side in depth)]


GENERATOR = Generator(
    mesh=box_in_mould,
    summary="A box in a mould, which may have a lid; it stands at height 0, its middle at 0.",
    models=("3d", *PLANE_MODELS),
    arguments={
        "box": SIDES.of(
            "[width, height, (depth)] of the casting, in x and y, in 3-D in x, z and y",
            (0.06, 0.04, 0.05),
        ),
        "wall": LENGTH.of("thickness of the mould", 0.02),
        "lid": YES_OR_NO.of("close the mould by a lid of the same thickness", False),
    },
    surfaces={"casting": ("top",), "mould": ("outside", "base", "top")},
    extents=_extents,
    moduli=lambda a, model: {"casting": block_modulus(a["box"])},
    problems=_problems,
)
