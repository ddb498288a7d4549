"""How far off walls with few cells across them are in bending.

Cells of low order cannot bend: a wall with one or two across deflects too little, or too much with
reduced dilatation. `BENDING` has the error of the tip of a cantilever, 20 times as long as thick,
clamped and with a force at its end, against S. P. Timoshenko, Philosophical Magazine 41 (1921) 744
(ν = 0.33; triangles with alternating diagonals, cubes of six tetrahedra each; unstructured meshes
with the same number of cells across are up to a third better).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

COUNTED = (1.0, 2.0, 4.0, 8.0)
"""Cells across for which errors were measured."""
BENDING: Mapping[tuple[str, str], tuple[float, float, float, float]] = {
    ("mixed", "triangle"): (-0.64, -0.31, -0.10, -0.03),
    ("displacement", "triangle"): (-0.70, -0.36, -0.12, -0.04),
    ("q1p0", "quadrilateral"): (0.28, 0.05, 0.01, 0.00),
    ("displacement", "quadrilateral"): (-0.40, -0.15, -0.04, -0.01),
    ("mixed", "tetrahedron"): (-0.68, -0.36, -0.13, -0.04),
    ("displacement", "tetrahedron"): (-0.79, -0.50, -0.22, -0.07),
    ("q1p0", "hexahedron"): (0.23, -0.02, -0.01, 0.00),
    ("displacement", "hexahedron"): (-0.37, -0.13, -0.04, -0.01),
}
"""Error of a deflection with these cells, by formulation and kind of cells."""
ENOUGH = 4.0
"""Cells across a wall from which nothing is said."""
LEAST_TOLD = 0.01
"""Part of a surface with a number of cells from which this number is told."""


@dataclass(frozen=True)
class ThinWalls:
    """The walls of a body with fewer than `ENOUGH` cells across.

    Attributes:
        body: its name.
        cells: kind of its cells, in the plural.
        formulation: of its mechanics.
        one: part of the surface that bounds walls with one cell across.
        two: with one or two.
        few: with fewer than four.
        thinnest: a tenth of these walls is thinner [m].
        thickest: a tenth is thicker [m].
        across: cells in the middle one of these walls.
        error: of its deflection.
        error_if_fine: with four cells across.
    """

    body: str
    cells: str
    formulation: str
    one: float
    two: float
    few: float
    thinnest: float
    thickest: float
    across: float
    error: float
    error_if_fine: float

    @property
    def size(self) -> float:
        """Size of cells with which four lie across the thinner ones, with two digits [m]."""
        return float(f"{self.thinnest / ENOUGH:.2g}")

    @property
    def text(self) -> str:
        """Where the walls are, what is off there, and the cure."""
        shares = ((self.one, "1"), (self.two - self.one, "2"), (self.few - self.two, "3"))
        seen = [(share, count) for share, count in shares if share >= LEAST_TOLD]
        told = ", ".join(f"{_percent(share)} with {count}" for share, count in seen)
        low, high = (f"{1e3 * length:.2g}" for length in (self.thinnest, self.thickest))
        thick = f"{low} mm" if low == high else f"{low} to {high} mm"
        way = "little" if self.error < 0.0 else "much"
        fine = _percent(abs(self.error_if_fine))
        cure = f"cells of {1e3 * self.size:.2g} mm there, 4 across, make {fine} of it"
        return (
            f"{self.body} has walls of {thick} with few cells across (of its surface {told}): "
            f"{self.cells} ({self.formulation}) bend there about {_percent(abs(self.error))} too "
            f"{way}, and distortion and stress of bending are off by as much; {cure}"
        )


def bending_error(formulation: str, cell: str, across: float) -> float | None:
    """Return the error of a deflection of a wall; None: not measured.

    Args:
        formulation: of the body.
        cell: kind of its cells.
        across: how many of them lie across the wall.
    """
    known = BENDING.get((formulation, cell))
    if known is None:
        return None
    return float(np.interp(np.log2(max(across, 1.0)), np.log2(COUNTED), known))


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %"
