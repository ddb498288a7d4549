"""A slab that a wall cools."""

from castx.meshes.bars import bars, checked_depth, sides
from castx.meshes.generators.declaration import DEPTH, LENGTH, MODELS, Generator
from castx.meshes.grading import Sizing, graded, require_positive
from castx.meshes.linear_mesh import SIMPLICES, checked_cells
from castx.meshes.model import fill_model, plane


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
    mesh = bars(graded(length, sizing), width, checked_depth(model, depth), size, cells)
    tolerance = 1e-8 * max(length, width)
    surfaces = [plane("wall", 0, 0.0, tolerance), plane("far", 0, length, tolerance)]
    fill_model(mesh, ["casting"], surfaces + sides(width, depth, tolerance))


GENERATOR = Generator(
    mesh=slab,
    summary="A casting in 0 ≤ x ≤ length, 0 ≤ y ≤ width; its wall is at x = 0.",
    models=MODELS,
    arguments={
        "length": LENGTH.of("extent in x", 0.1),
        "width": LENGTH.of("extent in y", 0.04),
        "depth": DEPTH,
    },
    surfaces={"casting": ("wall", "far", "bottom", "top", "front", "back")},
    extents=lambda a: [a["length"], a["width"], *([a["depth"]] if "depth" in a else [])],
)
