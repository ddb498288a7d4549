"""How far off walls with few cells across are: in bending, and in stress and shape once frozen.

Cells of low order cannot bend: a wall with one or two across deflects too little, or too much with
reduced dilatation. `BENDING` has the error of the tip of a cantilever, 20 times as long as thick,
clamped and with a force at its end, against S. P. Timoshenko, Philosophical Magazine 41 (1921) 744
(ν = 0.33; triangles with alternating diagonals, cubes of six tetrahedra each; unstructured meshes
with the same number of cells across are up to a third better).

A wall that cools from both sides is hotter inside by a parabola, which freezing turns into stress.
One quadratic cell with a linear pressure holds nothing to 11 % of this stress in
an elastic plate, two hold 94 %; one linear temperature has no parabola at all. `FREEZING` has two
errors of plates of 2 to 6 mm and a box of 3 mm, of AlSi7Mg or AlSi9Cu3: that of the residual stress
from place to place, root mean square over root mean square, about the middle of what was measured,
and the largest one of a bow or a lean.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from castx.input.units import plain_text

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
FREEZING: Mapping[str, tuple[tuple[float, float, float], tuple[float, float, float]]] = {
    "mixed": ((1.0, 0.8, 0.4), (0.6, 0.5, 0.17)),
    "taylor-hood": ((0.6, 0.4, 0.2), (0.5, 0.2, 0.12)),
}
"""Errors of residual stress and of distortion with 1, 2 and 4 cells across, by formulation."""
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
        error: of its deflection; None: its cells bend well.
        error_if_fine: with four cells across.
        freezing_error: of its residual stress from place to place, over the root mean square, and
            of its distortion at most; None: it does not freeze, or not measured.
        freezing_error_if_fine: with four cells across.
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
    error: float | None
    error_if_fine: float | None
    freezing_error: tuple[float, float] | None = None
    freezing_error_if_fine: tuple[float, float] | None = None

    @property
    def size(self) -> float:
        """Size of cells with which four lie across the thinner ones, with two digits [m]."""
        return float(f"{self.thinnest / ENOUGH:.2g}")

    @property
    def text(self) -> str:
        """Where the walls are, what is off there, and the cure."""
        off = "; ".join(text for text in (self._bending, self._freezing) if text)
        fine = ", ".join(text for text in (self._bending_if_fine, self._freezing_if_fine) if text)
        return self._told(off, fine)

    @property
    def bending_text(self) -> str:
        """Where the walls are, how far their deflection is off, and the cure."""
        return self._told(self._bending, self._bending_if_fine)

    @property
    def freezing_text(self) -> str:
        """Where the walls are, how far off their residual stress and distortion are; the cure."""
        return self._told(self._freezing, self._freezing_if_fine)

    def _told(self, off: str, fine: str) -> str:
        cure = f"cells of {plain_text(1e3 * self.size, 2)} mm there, 4 across, leave {fine}"
        return f"{self._place}: {off}; {cure}"

    @property
    def _bending_if_fine(self) -> str:
        return "" if self.error_if_fine is None else _percent(abs(self.error_if_fine))

    @property
    def _freezing_if_fine(self) -> str:
        known = self.freezing_error_if_fine
        return "" if known is None else " and ".join(_percent(error) for error in known)

    @property
    def _place(self) -> str:
        shares = ((self.one, "1"), (self.two - self.one, "2"), (self.few - self.two, "3"))
        seen = [(share, count) for share, count in shares if share >= LEAST_TOLD]
        told = ", ".join(f"{_percent(share)} with {count}" for share, count in seen)
        low, high = (plain_text(1e3 * length, 2) for length in (self.thinnest, self.thickest))
        thick = f"{low} mm" if low == high else f"{low} to {high} mm"
        return f"{self.body} has walls of {thick} with few cells across (of its surface {told})"

    @property
    def _bending(self) -> str:
        """How far the deflection is off; empty: little."""
        if self.error is None:
            return ""
        way = "little" if self.error < 0.0 else "much"
        return (
            f"{self.cells} ({self.formulation}) bend there about {_percent(abs(self.error))} too "
            f"{way}, and distortion and stress of bending are off by as much"
        )

    @property
    def _freezing(self) -> str:
        """How far residual stress and distortion are off; empty: no freezing, or not measured."""
        if self.freezing_error is None:
            return ""
        stress, distortion = map(_percent, self.freezing_error)
        return (
            f"residual stress is about {stress} of its root mean square off from place to place, "
            f"and the distortion by it up to {distortion}"
        )


def bending_error(formulation: str, cell: str, across: float) -> float | None:
    """Return the error of a deflection of a wall; None: not measured.

    Args:
        formulation: of the body.
        cell: kind of its cells.
        across: how many of them lie across the wall.
    """
    known = BENDING.get((formulation, cell))
    return None if known is None else _between(across, known)


def freezing_error(formulation: str, across: float) -> tuple[float, float] | None:
    """Return the errors of residual stress and distortion of a wall that freezes; None: unknown.

    Args:
        formulation: of the body.
        across: how many cells lie across the wall.
    """
    known = FREEZING.get(formulation)
    if known is None:
        return None
    stress, distortion = (_between(across, errors) for errors in known)
    return stress, distortion


def _between(across: float, errors: Sequence[float]) -> float:
    """Return an error between those with the first of `COUNTED` cells, by the logarithm."""
    counted = np.log2(COUNTED[: len(errors)])
    return float(np.interp(np.log2(max(across, 1.0)), counted, errors))


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %"
