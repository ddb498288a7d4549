"""A plate with steps in its thickness, in a mould."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.meshes.bars import checked_depth
from castx.meshes.generators.declaration import (
    DEPTH,
    LENGTH,
    LENGTHS,
    PLANE_MODELS,
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
from castx.meshes.linear_mesh import SIMPLICES, checked_cells
from castx.meshes.model import base_top_and_outside, fill_model
from castx.meshes.modulus import prism_modulus
from castx.meshes.structured import grid, swept

CASTING, MOULD = 0, 1


def step_plate(
    *,
    model: str,
    lengths: Sequence[float],
    thicknesses: Sequence[float],
    wall: float,
    size: float,
    depth: float | None = None,
    lid: bool = False,
    interface_size: float | None = None,
    order_of_growth: float = 1.0,
    cells: str = SIMPLICES,
) -> None:
    """Mesh a plate of sections of different thickness, 0 <= x, on a level floor at height 0.

    The last coordinate points up; in 3-D the plate is centred at y = 0, and the mesh is its own
    mirror image in y = 0. Without a lid the mould ends at the height of the thickest sections,
    whose top is free, and covers the thinner ones. Surfaces: casting: top, without a lid; mould:
    outside (its sides), base (its lowest face), top (its highest one).

    Args:
        model: a plane model, of the section along the plate, or "3d".
        lengths: of the sections in x [m].
        thicknesses: of the sections [m].
        wall: thickness of the mould at the ends, on the sides and below [m].
        size: element size [m]; across a section are at least two.
        depth: extent of the casting in y in 3-D [m].
        lid: close the mould with a lid of the same thickness.
        interface_size: element size at the interface [m].
        order_of_growth: exponent with which the size grows away from the interface.
        cells: "simplices" or "quadrilaterals" (hexahedra in 3-D).
    """
    checked_cells(cells)
    sizing = Sizing(size, interface_size, order_of_growth)
    _check(model, lengths, thicknesses, wall)
    depth = checked_depth(model, depth)
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    heights = _distinct(thicknesses)
    outside = graded(wall, sizing)
    corner = len(outside) - 1
    x = between_walls(graded_through(ends, sizing), outside)
    z = between_walls(graded_through(np.append(0.0, heights), sizing), outside)
    z = z if lid else z[:-corner]
    above = np.array([0.0, *thicknesses, 0.0])  # of the wall, of each section, of the wall
    if depth is None:
        mesh = grid(
            x, z, lambda m: _body(m[:, 1], above[np.searchsorted(ends, m[:, 0])]), cells,
            (corner, corner),
        )  # fmt: skip
    else:
        half = 0.5 * depth
        y = between_walls(graded_through(np.array([-half, half]), sizing), outside)
        plan = grid(
            x, y,
            lambda m: np.where(np.abs(m[:, 1]) < half, np.searchsorted(ends, m[:, 0]), 0),
            cells, (corner, corner),
        )  # fmt: skip
        mesh = swept(plan, z, lambda section, z: _body(z, above[section]), corner)
    tolerance = 1e-8 * (ends[-1] + heights[-1] + wall)
    up = mesh.dimension - 1
    fill_model(mesh, ["casting", "mould"], base_top_and_outside(up, z, tolerance))


def _check(model: str, lengths: Sequence[float], thicknesses: Sequence[float], wall: float) -> None:
    if model == "axisymmetric":
        raise ValueError("a plate has ends; the axisymmetric generator is cylinder_in_mould")
    if len(lengths) != len(thicknesses):
        raise ValueError(f"{len(lengths)} lengths, but {len(thicknesses)} thicknesses")
    for length in lengths:
        require_positive(**{"each of lengths": length})
    for thickness in thicknesses:
        require_positive(**{"each of thicknesses": thickness})
    require_positive(wall=wall)


def _distinct(thicknesses: Sequence[float]) -> FloatArray:
    """Return the different thicknesses in ascending order, round-off apart."""
    largest = max(thicknesses)
    return np.unique(np.round(np.array(thicknesses) / largest, 9)) * largest


def _body(height: FloatArray | float, thickness: FloatArray) -> LongArray:
    """Return the body at a height over the floor where the casting has a thickness."""
    return np.where((height > 0) & (height < thickness), CASTING, MOULD)


def _problems(arguments: Arguments, model: str) -> Iterator[tuple[str, str]]:
    sections = len(arguments["lengths"])
    if len(arguments["thicknesses"]) != sections:
        yield "thicknesses", f"one is needed for each of the {sections} lengths"


def _extents(arguments: Arguments) -> list[float]:
    walls = 2 * arguments["wall"]
    above = walls if arguments.get("lid", False) else arguments["wall"]
    deep = [arguments["depth"] + walls] if "depth" in arguments else []
    return [sum(arguments["lengths"]) + walls, max(arguments["thicknesses"]) + above, *deep]


def _moduli(arguments: Arguments, model: str) -> dict[str, float]:
    lengths, thicknesses = arguments["lengths"], arguments["thicknesses"]
    area = sum(long * thick for long, thick in zip(lengths, thicknesses, strict=True))
    steps = sum(abs(after - before) for before, after in pairwise(thicknesses))
    around = 2.0 * sum(lengths) + thicknesses[0] + thicknesses[-1] + steps
    return {"casting": prism_modulus(area, around, arguments.get("depth"))}


GENERATOR = Generator(
    mesh=step_plate,
    summary="A plate of sections of different thickness, x ≥ 0 and on height 0, in a mould, which "
    "may have a lid.",
    models=("3d", *PLANE_MODELS),
    arguments={
        "lengths": LENGTHS.of("of the sections along x", (0.05, 0.06)),
        "thicknesses": LENGTHS.of("of the sections", (0.03, 0.015)),
        "depth": DEPTH.of("extent of the casting along y", 0.04),
        "wall": LENGTH.of("thickness of the mould at the ends, on the sides and below", 0.02),
        "lid": YES_OR_NO.of("close the mould by a lid of the same thickness", False),
    },
    surfaces={"casting": ("top",), "mould": ("outside", "base", "top")},
    extents=_extents,
    moduli=_moduli,
    problems=_problems,
)
