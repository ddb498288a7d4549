"""The strain range of the cells of a die over a cycle, Δε = √(2/3) ‖dev Δε_m‖.

The mechanical strain ε_m = 3/2 σ/E + ε_vp, with E at the temperature of the cell, is followed as
a path; the first part has the von Mises stress over E as its equivalent, like a bar. Components are
subtracted and then made one number, after ASME BPVC III-5, HBB-T-1413: stress and flow of one
direction add up, Δσ_vM/E + Δε_eq as in a settled cycle; when a clamped surface that has yielded hot
is drawn as it cools they are of opposite ones, and its strain is what is left of both. The range is
the distance between the two states of the cycle that were farthest apart, the width of the loop as
Coffin and Manson mean it: L. F. Coffin, Trans. ASME 76 (1954) 931; S. S. Manson, NACA TN 2933
(1953). The two are found by keeping a pair and replacing one of both by a new state that is farther
from the other. On a straight path that is exact, on a bent one at most a little too small.
"""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.stateful import Arrays, Numbering, Saved, number

MOMENTS = ("first", "second", "last")
STRAIN, TEMPERATURE, SIZE = slice(0, 6), 6, 7
"""Columns of a state."""


def distance(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return √(2/3) ‖dev(a - b)‖ of tensors (cells, 6) in the order xx, yy, zz, xy, xz, yz."""
    away = one - other
    normal = away[:, :3] - away[:, :3].mean(axis=1, keepdims=True)
    return np.asarray(np.sqrt((np.sum(normal**2, 1) + 2.0 * np.sum(away[:, 3:] ** 2, 1)) / 1.5))


class StrainCycle:
    """Extremes of the present cycle, and those of the last whole one.

    Their distance is the range, Δε = √(2/3) ‖dev Δ(3/2 σ/E + ε_vp)‖.

    Args:
        cells: owned by this rank.
        numbering: of the cells, for saved states.
    """

    def __init__(self, cells: int, numbering: Numbering) -> None:
        self._numbering = numbering
        self._states: dict[str, FloatArray] = {name: np.zeros((cells, SIZE)) for name in MOMENTS}
        self._whole: FloatArray = np.full((cells, 2), np.nan)
        self._cycle = -1

    def update(
        self,
        cycle: int,
        stress: FloatArray,
        plastic: FloatArray,
        temperature: FloatArray,
        ended: bool = False,
    ) -> None:
        """Take over the state at the end of a step.

        Args:
            cycle: to which the step belongs.
            stress: over Young's modulus at the temperature of the cell, (cells, 6).
            plastic: viscoplastic strain, (cells, 6).
            temperature: of the cells, (cells,) [°C].
            ended: whether the cycle ends with this step.
        """
        now = np.column_stack([1.5 * stress + plastic, temperature])
        if self._cycle < 0:
            self._states = {name: now.copy() for name in MOMENTS}
        elif cycle != self._cycle:
            self._states |= {name: self._states["last"].copy() for name in MOMENTS[:2]}
        self._cycle = cycle
        first, second = self._states["first"], self._states["second"]
        from_first, from_second = (_width(now, state) for state in (first, second))
        farther = np.maximum(from_first, from_second) > _width(first, second)
        instead_of_first = farther & (from_second >= from_first)
        instead_of_second = farther & ~instead_of_first
        first[instead_of_first] = now[instead_of_first]
        second[instead_of_second] = now[instead_of_second]
        self._states["last"] = now
        if ended:
            self._whole = np.column_stack([self._range(), self._middle()])

    def _range(self) -> FloatArray:
        return _width(self._states["first"], self._states["second"])

    def _middle(self) -> FloatArray:
        first, second = self._states["first"], self._states["second"]
        return np.asarray(0.5 * (first[:, TEMPERATURE] + second[:, TEMPERATURE]))

    @property
    def strain_range(self) -> FloatArray:
        """Δε of the last whole cycle, of the present one in the first, (cells,)."""
        whole = self._whole[:, 0]
        return whole if np.isfinite(whole).all() else self._range()

    @property
    def temperature(self) -> FloatArray:
        """Mean temperature of the two extremes of the same cycle, (cells,) [°C]."""
        whole = self._whole[:, 0]
        return self._whole[:, 1] if np.isfinite(whole).all() else self._middle()

    def saved(self) -> dict[str, Saved]:
        """Return the extremes so far."""
        cells = {**self._states, "whole": self._whole}
        found = {name: Saved(values, self._numbering) for name, values in cells.items()}
        return found | {"cycle": number(self._cycle)}

    def restore(self, arrays: Arrays) -> None:
        """Go on with the extremes of an earlier part of the run."""
        cells = len(self._whole)
        self._states = {name: arrays[name][:cells].copy() for name in MOMENTS}
        self._whole = arrays["whole"][:cells].copy()
        self._cycle = int(arrays["cycle"])


def _width(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the strain between states (cells, 7), (cells,)."""
    return distance(one[:, STRAIN], other[:, STRAIN])
