"""A ring cast around a core."""

from collections.abc import Iterator

import numpy as np

from castx.meshes.generators.declaration import (
    LENGTH,
    LENGTH_OR_ZERO,
    MODELS,
    SECTOR,
    SYMMETRY_PLANES,
    Arguments,
    Generator,
)
from castx.meshes.grading import Sizing, graded, require_positive, uniform
from castx.meshes.linear_mesh import SIMPLICES, LinearMesh, checked_cells
from castx.meshes.model import Surface, fill_model, plane, round_surface, symmetry_plane
from castx.meshes.modulus import ring_modulus
from castx.meshes.o_grid import Radii
from castx.meshes.round_section import disc
from castx.meshes.structured import grid, swept


def core_in_ring(
    *,
    model: str,
    core_radius: float,
    outer_radius: float,
    size: float,
    height: float | None = None,
    core_bore: float = 0.0,
    sector: str = "full",
    interface_size: float | None = None,
    order_of_growth: float = 1.0,
    cells: str = SIMPLICES,
) -> None:
    """Mesh a core, hollow with core_bore > 0, in a ring-shaped casting that shrinks onto it.

    Surfaces: core: bore; casting: outside; both: base (z = 0), top (z = height). Plane models mesh
    the quarter cross-section with symmetry-x (x = 0), symmetry-y (y = 0) and no base or top.

    Args:
        model: the case's model.
        core_radius: radius of the interface [m].
        outer_radius: of the casting [m].
        size: element size [m].
        height: of both bodies [m]; unused in plane models.
        core_bore: radius of the core's bore, 0 for a solid core [m].
        sector: "full", "half" (x >= 0) or "quarter" of the 3-D body.
        interface_size: element size at the interface [m].
        order_of_growth: exponent with which the size grows away from the interface.
        cells: "simplices" or "quadrilaterals", of which round plans keep to the size along the
            interface and are longer outside of it.
    """
    checked_cells(cells)
    sizing = Sizing(size, interface_size, order_of_growth)
    if not 0 <= core_bore < core_radius < outer_radius:
        raise ValueError(
            "need 0 <= core_bore < core_radius < outer_radius, "
            f"got {core_bore:g}, {core_radius:g}, {outer_radius:g} m"
        )
    if model not in ("3d", "axisymmetric"):
        sector, height = "quarter", None
    elif height is None:
        raise ValueError(f'the model "{model}" needs a height')
    else:
        require_positive(height=height)
    radii = (core_bore, core_radius, outer_radius)
    if model == "axisymmetric":
        mesh = _half_section(radii, height or 0.0, sizing, cells)
    else:
        mesh = disc(radii, sizing, sector, cells)
    if model == "3d":
        mesh = swept(mesh, uniform(height or 0.0, size), lambda ring, middle: ring)
    fill_model(mesh, ["core", "casting"], _surfaces(model, radii, height, sector))


def _half_section(radii: Radii, height: float, sizing: Sizing, cells: str) -> LinearMesh:
    bore, interface, outer = radii
    r = np.concatenate(
        [interface - graded(interface - bore, sizing)[::-1],
         interface + graded(outer - interface, sizing)[1:]]
    )  # fmt: skip
    r[0] = bore
    z = uniform(height, sizing.size)
    return grid(r, z, lambda m: (m[:, 0] > interface).astype(int), cells)


def _surfaces(model: str, radii: Radii, height: float | None, sector: str) -> list[Surface]:
    tolerance = 1e-8 * (radii[-1] + (height or 0.0))
    surfaces = []
    if height is not None:
        up = 1 if model == "axisymmetric" else 2
        surfaces += [plane("base", up, 0.0, tolerance), plane("top", up, height, tolerance)]
    if model == "axisymmetric":
        surfaces.append(plane("outside", 0, radii[-1], tolerance))
        return [*surfaces, plane("bore", 0, radii[0], tolerance)] if radii[0] > 0 else surfaces
    sides = {"full": [], "half": [0], "quarter": [0, 1]}[sector]
    surfaces += [plane(symmetry_plane(a), a, 0.0, tolerance) for a in sides]
    surfaces += [
        round_surface("outside", radii[-1], tolerance),
        round_surface("bore", radii[0], tolerance),
    ]
    return surfaces


def _problems(arguments: Arguments, model: str) -> Iterator[tuple[str, str]]:
    if arguments.get("core_bore", 0.0) >= arguments["core_radius"]:
        yield "core_bore", "must be smaller than core_radius"
    if arguments["core_radius"] >= arguments["outer_radius"]:
        yield "outer_radius", "must be larger than core_radius"


GENERATOR = Generator(
    mesh=core_in_ring,
    summary="A ring cast round a core, z ≥ 0; plane models mesh a quarter of its section.",
    models=MODELS,
    arguments={
        "core_radius": LENGTH.of("of the interface", 0.03),
        "core_bore": LENGTH_OR_ZERO.of("radius of the core's bore", 0.01),
        "outer_radius": LENGTH.of("of the casting", 0.06),
        "height": LENGTH.of("of both bodies", 0.04, needed=("3d", "axisymmetric")),
        "sector": SECTOR,
    },
    surfaces={
        "core": ("bore", "base", "top", *SYMMETRY_PLANES),
        "casting": ("outside", "base", "top", *SYMMETRY_PLANES),
    },
    extents=lambda a: [a["outer_radius"], a.get("height", a["outer_radius"])],
    moduli=lambda a, model: {
        "casting": ring_modulus(a["core_radius"], a["outer_radius"], a.get("height"))
    },
    problems=_problems,
)
