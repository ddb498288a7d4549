"""Numbers that vary with place and time, at the points where they are asked for."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Protocol

import numpy as np

from castx.arrays import FloatArray
from castx.input.placed import NOW, Placed, PlacedTable

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(5)


class OverTime(Protocol):
    """A number over time, or one of each of some points, as `castx.tables.Table` is."""

    def __call__(self, argument: Any) -> FloatArray:
        """Return the value at a time [s], or the values of all points."""
        ...

    def mean(self, start: float, end: float) -> float | FloatArray:
        """Return the mean between two times [s], or those of all points."""
        ...


@dataclass(frozen=True, eq=False)
class PlacedThere:
    """A number of place and time at some points.

    Attributes:
        placed: by a formula or a table.
        points: (n, gdim) [m].
    """

    placed: Placed
    points: FloatArray

    def __call__(self, argument: float) -> FloatArray:
        """Return the numbers at a time [s], shape (n,)."""
        return self.placed(self.points, argument)

    def mean(self, start: float, end: float) -> FloatArray:
        """Return the means between two times [s], shape (n,).

        Exact of tables; of formulas by Gauss's rule of five points. The time before 0 is left out,
        where a formula may have no value.
        """
        start, end = max(start, 0.0), max(end, 0.0)
        if end <= start or NOW not in self.placed.axes:
            return self(end)
        ends = np.concatenate([[start], self._bends(start, end), [end]])
        total = np.zeros(len(self.points))
        for low, high in pairwise(ends):
            for at, weight in zip(_POINTS, _WEIGHTS, strict=True):
                now = 0.5 * ((high - low) * at + high + low)
                total += 0.5 * (high - low) * weight * self(float(now))
        return np.asarray(total / (end - start))

    def _bends(self, start: float, end: float) -> FloatArray:
        """Return the times of a table between two times."""
        if not isinstance(self.placed, PlacedTable):
            return np.empty(0)
        times = self.placed.places[self.placed.axes.index(NOW)]
        return np.asarray(times[(times > start) & (times < end)])
