"""The strain range of the cells of a die over a cycle, Δε = Δσ_vM/E + Δε_eq.

The stress over E at its own temperature is followed as a path; its range is the distance of von
Mises between the two states of the cycle that were farthest apart, found by keeping a pair and
replacing one of both by a new state that is farther from the other. On a straight path that is
exact, on a bent one at most a little too small. Viscoplastic strain adds up over the cycle.
"""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.stateful import Arrays, Numbering, Saved, number

MOMENTS = ("first", "second", "last")


def distance(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return √(3/2)‖dev(a - b)‖ of tensors (cells, 6) in the order xx, yy, zz, xy, xz, yz."""
    away = one - other
    normal = away[:, :3] - away[:, :3].mean(axis=1, keepdims=True)
    return np.asarray(np.sqrt(1.5 * (np.sum(normal**2, 1) + 2.0 * np.sum(away[:, 3:] ** 2, 1))))


class StrainCycle:
    """Extremes of the present cycle, and those of the last whole one.

    Args:
        cells: owned by this rank.
        numbering: of the cells, for saved states.
    """

    def __init__(self, cells: int, numbering: Numbering) -> None:
        self._numbering = numbering
        self._states: dict[str, FloatArray] = {name: np.zeros((cells, 8)) for name in MOMENTS}
        self._start: FloatArray = np.zeros(cells)
        self._whole: FloatArray = np.full((cells, 2), np.nan)
        self._cycle = -1

    def update(
        self, cycle: int, stress: FloatArray, plastic: FloatArray, temperature: FloatArray
    ) -> None:
        """Take over the state at the end of a step.

        Args:
            cycle: to which the step belongs.
            stress: over Young's modulus at the temperature of the cell, (cells, 6).
            plastic: equivalent viscoplastic strain, (cells,).
            temperature: of the cells, (cells,) [°C].
        """
        now = np.column_stack([stress, plastic, temperature])
        if self._cycle < 0:
            self._states = {name: now.copy() for name in MOMENTS}
            self._start = plastic.copy()
        elif cycle != self._cycle:
            self._whole = np.column_stack([self._range(), self._middle()])
            self._states |= {name: self._states["last"].copy() for name in MOMENTS[:2]}
            self._start = self._states["last"][:, 6].copy()
        self._cycle = cycle
        first, second = self._states["first"], self._states["second"]
        width = distance(first[:, :6], second[:, :6])
        from_first, from_second = (distance(now[:, :6], s[:, :6]) for s in (first, second))
        farther = np.maximum(from_first, from_second) > width
        instead_of_first = farther & (from_second >= from_first)
        instead_of_second = farther & ~instead_of_first
        first[instead_of_first] = now[instead_of_first]
        second[instead_of_second] = now[instead_of_second]
        self._states["last"] = now

    def _range(self) -> FloatArray:
        first, second, last = (self._states[name] for name in MOMENTS)
        return distance(first[:, :6], second[:, :6]) + last[:, 6] - self._start

    def _middle(self) -> FloatArray:
        return 0.5 * (self._states["first"][:, 7] + self._states["second"][:, 7])

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
        cells = {**self._states, "start": self._start, "whole": self._whole}
        found = {name: Saved(values, self._numbering) for name, values in cells.items()}
        return found | {"cycle": number(self._cycle)}

    def restore(self, arrays: Arrays) -> None:
        """Go on with the extremes of an earlier part of the run."""
        cells = len(self._whole)
        self._states = {name: arrays[name][:cells].copy() for name in MOMENTS}
        self._start, self._whole = arrays["start"][:cells].copy(), arrays["whole"][:cells].copy()
        self._cycle = int(arrays["cycle"])
