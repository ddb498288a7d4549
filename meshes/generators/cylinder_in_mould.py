"""A cylinder in a cup or sleeve."""

import numpy as np

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.meshes.generators.declaration import (
    LENGTH,
    LENGTH_OR_ZERO,
    SECTOR,
    SYMMETRY_PLANES,
    Generator,
)
from castx.meshes.grading import Sizing, graded, require_positive, uniform
from castx.meshes.linear_mesh import SIMPLICES, checked_cells
from castx.meshes.model import fill_model, plane, round_surface, symmetry_plane
from castx.meshes.modulus import ring_modulus
from castx.meshes.round_section import disc
from castx.meshes.structured import grid, swept

CASTING, MOULD = 0, 1


def cylinder_in_mould(
    *,
    model: str,
    radius: float,
    height: float,
    wall: float,
    size: float,
    floor: float = 0.0,
    sector: str = "full",
    interface_size: float | None = None,
    order_of_growth: float = 1.0,
    cells: str = SIMPLICES,
) -> None:
    """Mesh a cylinder, 0 <= z <= height, in a mould with a wall and, with floor > 0, a floor.

    Surfaces: casting: top, base (z = 0, part of the interface when there is a floor); mould:
    outside, top, base (z = -floor); in 3-D symmetry-x (x = 0) and symmetry-y (y = 0) of a quarter,
    symmetry-x of a half.

    Args:
        model: "axisymmetric" or "3d".
        radius: of the casting [m].
        height: of the casting and the mould's wall [m].
        wall: thickness of the mould's wall [m].
        size: element size [m].
        floor: thickness of the mould's floor, 0 for an open sleeve [m].
        sector: "full", "half" (x >= 0) or "quarter" of the 3-D body.
        interface_size: element size at the interface [m].
        order_of_growth: exponent with which the size grows away from the interface.
        cells: "simplices" or "quadrilaterals"; hexahedra keep to the size along the interface and
            are longer outside of it.
    """
    checked_cells(cells)
    sizing = Sizing(size, interface_size, order_of_growth)
    require_positive(radius=radius, height=height, wall=wall)
    if floor < 0:
        raise ValueError(f"floor must be 0 or a thickness, got {floor:g} m")
    z = _levels(height, floor, sizing)
    tolerance = 1e-8 * (radius + wall + height)
    surfaces = [
        plane("top", 2, height, tolerance),
        plane("base", 2, -floor, tolerance),
        round_surface("outside", radius + wall, tolerance),
    ]
    if model == "axisymmetric":
        r = np.concatenate([radius - graded(radius, sizing)[:0:-1], radius + graded(wall, sizing)])
        mesh = grid(r, z, lambda m: _body(m[:, 0] > radius, m[:, 1] < 0), cells)
        surfaces = [
            plane("top", 1, height, tolerance),
            plane("base", 1, -floor, tolerance),
            plane("outside", 0, radius + wall, tolerance),
        ]
    elif model == "3d":
        plan = disc((0.0, radius, radius + wall), sizing, sector, cells)
        mesh = swept(plan, z, lambda ring, middle: _body(ring == 1, np.full(len(ring), middle < 0)))
        sides = {"full": [], "half": [0], "quarter": [0, 1]}[sector]
        surfaces = [plane(symmetry_plane(a), a, 0.0, tolerance) for a in sides] + surfaces
    else:
        raise ValueError(f'cylinder_in_mould needs the model "axisymmetric" or "3d", got "{model}"')
    fill_model(mesh, ["casting", "mould"], surfaces)


def _levels(height: float, floor: float, sizing: Sizing) -> FloatArray:
    if floor == 0:
        return uniform(height, sizing.size)
    return np.concatenate([-graded(floor, sizing)[:0:-1], graded(height, sizing)])


def _body(in_wall: BoolArray, in_floor: BoolArray) -> LongArray:
    return np.where(in_wall | in_floor, MOULD, CASTING)


GENERATOR = Generator(
    mesh=cylinder_in_mould,
    summary="A cylinder, 0 ≤ z ≤ height, in a sleeve, or in a cup where the mould has a floor.",
    models=("3d", "axisymmetric"),
    arguments={
        "radius": LENGTH.of("of the casting", 0.03),
        "height": LENGTH.of("of the casting and of the mould's wall", 0.06),
        "wall": LENGTH.of("thickness of the mould's wall", 0.02),
        "floor": LENGTH_OR_ZERO.of("thickness of the mould's floor", 0.0),
        "sector": SECTOR,
    },
    surfaces={
        "casting": ("base", "top", *SYMMETRY_PLANES),
        "mould": ("outside", "base", "top", *SYMMETRY_PLANES),
    },
    extents=lambda a: [a["radius"] + a["wall"], a["height"] + a.get("floor", 0.0)],
    moduli=lambda a, model: {"casting": ring_modulus(0.0, a["radius"], a["height"])},
)
