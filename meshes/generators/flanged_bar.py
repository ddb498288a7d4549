"""A round bar with a flange in its mould."""

from collections.abc import Iterator

import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.meshes.generators.declaration import LENGTH, Arguments, Generator
from castx.meshes.grading import Sizing, graded, graded_through, require_positive
from castx.meshes.linear_mesh import SIMPLICES, checked_cells
from castx.meshes.model import fill_model, plane
from castx.meshes.structured import grid

CASTING, MOULD = 0, 1


def flanged_bar(
    *,
    model: str,
    bar_radius: float,
    length: float,
    flange_radius: float,
    flange_thickness: float,
    wall: float,
    size: float,
    interface_size: float | None = None,
    order_of_growth: float = 1.0,
    cells: str = SIMPLICES,
) -> None:
    """Mesh a bar along z whose flange, 0 <= z <= flange_thickness, clamps the mould behind it.

    The bar leaves its mould at z = length, as towards a load cell. Surfaces: casting: top
    (z = length); mould: base (z = -wall), top (z = length), outside.

    Args:
        model: "axisymmetric".
        bar_radius: of the bar [m].
        length: from the face of the flange to the end of the bar [m].
        flange_radius: of the flange [m].
        flange_thickness: of the flange [m].
        wall: thickness of the mould before the flange and round it [m].
        size: element size [m].
        interface_size: element size at the interface [m].
        order_of_growth: exponent with which the size grows away from the interface.
        cells: "simplices" or "quadrilaterals".
    """
    checked_cells(cells)
    if model != "axisymmetric":
        raise ValueError(f'flanged_bar needs the model "axisymmetric", got "{model}"')
    require_positive(
        bar_radius=bar_radius, length=length, flange_thickness=flange_thickness, wall=wall
    )
    if not bar_radius * (1.0 + 1e-9) < flange_radius:
        raise ValueError(
            f"need bar_radius < flange_radius, got {bar_radius:g} and {flange_radius:g} m"
        )
    if not flange_thickness * (1.0 + 1e-9) < length:
        raise ValueError(
            f"need flange_thickness < length, got {flange_thickness:g} and {length:g} m"
        )
    sizing = Sizing(size, interface_size, order_of_growth)
    outside, inside = graded(wall, sizing), graded(bar_radius, sizing)
    r = np.concatenate(
        [bar_radius - inside[::-1],
         graded_through(np.array([bar_radius, flange_radius]), sizing)[1:],
         flange_radius + outside[1:]]
    )  # fmt: skip
    r[0] = 0.0
    z = np.concatenate(
        [-outside[::-1],
         graded_through(np.array([0.0, flange_thickness]), sizing)[1:],
         flange_thickness + graded(length - flange_thickness, sizing)[1:]]
    )  # fmt: skip

    def body(middle: FloatArray) -> LongArray:
        radius = np.where(middle[:, 1] < flange_thickness, flange_radius, bar_radius)
        return np.where((middle[:, 1] > 0.0) & (middle[:, 0] < radius), CASTING, MOULD)

    mesh = grid(r, z, body, cells, (len(inside) - 1, len(outside) - 1))
    tolerance = 1e-8 * (length + flange_radius + wall)
    surfaces = [
        plane("top", 1, length, tolerance),
        plane("base", 1, -wall, tolerance),
        plane("outside", 0, flange_radius + wall, tolerance),
    ]
    fill_model(mesh, ["casting", "mould"], surfaces)


def _problems(arguments: Arguments, model: str) -> Iterator[tuple[str, str]]:
    if arguments["flange_radius"] <= arguments["bar_radius"] * (1.0 + 1e-9):
        yield "flange_radius", "must be larger than bar_radius"
    if arguments["length"] <= arguments["flange_thickness"] * (1.0 + 1e-9):
        yield "flange_thickness", "must be smaller than length"


def _moduli(arguments: Arguments, model: str) -> dict[str, float]:
    """Return the volume of the casting over its surface [m]."""
    bar, flange = arguments["bar_radius"], arguments["flange_radius"]
    thickness, length = arguments["flange_thickness"], arguments["length"]
    behind = length - thickness
    volume = flange**2 * thickness + bar**2 * behind
    surface = 2.0 * (flange**2 + flange * thickness + bar * behind)
    return {"casting": volume / surface}


GENERATOR = Generator(
    mesh=flanged_bar,
    summary="A round bar whose flange clamps its mould, as for a load cell.",
    models=("axisymmetric",),
    arguments={
        "bar_radius": LENGTH.of("of the bar", 0.01),
        "length": LENGTH.of("from the face of the flange to the end of the bar", 0.1),
        "flange_radius": LENGTH.of("of the flange", 0.025),
        "flange_thickness": LENGTH.of("of the flange", 0.015),
        "wall": LENGTH.of("thickness of the mould before the flange and round it", 0.02),
    },
    surfaces={"casting": ("top",), "mould": ("base", "top", "outside")},
    extents=lambda a: [a["flange_radius"] + a["wall"], a["length"] + a["wall"]],
    moduli=_moduli,
    problems=_problems,
)
