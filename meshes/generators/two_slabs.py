"""Two slabs face to face."""

import numpy as np

from castx.meshes.bars import bars, checked_depth, sides
from castx.meshes.generators.declaration import DEPTH, LENGTH, PLANE_MODELS, Generator
from castx.meshes.grading import Sizing, graded, require_positive
from castx.meshes.linear_mesh import SIMPLICES, checked_cells
from castx.meshes.model import fill_model, plane
from castx.meshes.modulus import block_modulus


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
    mesh = bars(x, width, checked_depth(model, depth), size, cells)
    tolerance = 1e-8 * max(length, mould_length, width)
    surfaces = [plane("far", 0, -mould_length, tolerance), plane("far", 0, length, tolerance)]
    fill_model(mesh, ["casting", "mould"], surfaces + sides(width, depth, tolerance))


GENERATOR = Generator(
    mesh=two_slabs,
    summary="A casting (x > 0) and a mould (x < 0) that meet at x = 0.",
    models=("3d", *PLANE_MODELS),
    arguments={
        "length": LENGTH.of("extent of the casting in x", 0.1),
        "mould_length": LENGTH.of("extent of the mould in x", 0.06),
        "width": LENGTH.of("extent in y", 0.04),
        "depth": DEPTH,
    },
    surfaces=dict.fromkeys(("casting", "mould"), ("far", "bottom", "top", "front", "back")),
    moduli=lambda a, model: {
        name: block_modulus([a[along], a["width"], *([a["depth"]] if "depth" in a else [])])
        for name, along in (("casting", "length"), ("mould", "mould_length"))
    },
    extents=lambda a: [
        a["length"] + a["mould_length"],
        a["width"],
        *([a["depth"]] if "depth" in a else []),
    ],
)
