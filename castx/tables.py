"""Piecewise linear functions of one variable, for properties and for values over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.errors import CaseError


@dataclass(frozen=True, eq=False)
class Table:
    """Piecewise linear function, constant outside its points.

    Args:
        arguments: strictly increasing abscissae, shape (points,).
        values: ordinates, shape (points,).

    Raises:
        CaseError: the lengths differ, a number is not finite or the arguments do not increase.
    """

    arguments: FloatArray
    values: FloatArray

    def __post_init__(self) -> None:
        for name in ("arguments", "values"):
            array = np.array(getattr(self, name), dtype=np.float64)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if self.arguments.ndim != 1 or self.arguments.shape != self.values.shape:
            raise CaseError(
                f"a table needs as many values as arguments, got shapes "
                f"{self.values.shape} and {self.arguments.shape}"
            )
        if not (np.isfinite(self.arguments).all() and np.isfinite(self.values).all()):
            raise CaseError("a table holds a number that is not finite")
        if self.arguments.size == 0 or (np.diff(self.arguments) <= 0).any():
            raise CaseError(
                f"the arguments of a table must increase strictly, got {self.arguments.tolist()}"
            )

    @classmethod
    def constant(cls, value: float) -> Table:
        """Return the table that has one value everywhere."""
        return cls(np.zeros(1), np.array([value]))

    @classmethod
    def from_points(cls, points: Sequence[Sequence[float]]) -> Table:
        """Return the table through rows of (argument, value)."""
        array = np.asarray(points, dtype=np.float64)
        if array.ndim != 2 or array.shape[1] != 2:
            raise CaseError(f"a table needs rows of two numbers, got {points!r}")
        return cls(array[:, 0], array[:, 1])

    @property
    def is_constant(self) -> bool:
        """Whether the table has the same value everywhere."""
        return bool((self.values == self.values[0]).all())

    def __call__(self, argument: Any) -> FloatArray:
        """Return the values at an array of arguments, in its shape."""
        return np.asarray(np.interp(argument, self.arguments, self.values))

    def mean(self, start: float, end: float) -> float:
        """Return the exact mean value between two arguments, or the value where they are equal."""
        if end <= start:
            return float(self(end))
        inside = self.arguments[(self.arguments > start) & (self.arguments < end)]
        points = np.concatenate(([start], inside, [end]))
        values = self(points)
        return float(np.diff(points) @ (values[1:] + values[:-1])) / (2.0 * (end - start))

    def corners(self, share: float) -> FloatArray:
        """Return the arguments between which straight lines give the table, the ends included.

        Args:
            share: part of the range of the values by which the lines may miss them (D. H. Douglas
                and T. K. Peucker, Cartographica 10 (1973)).

        Returns:
            Arguments in ascending order; none of a constant.
        """
        if self.is_constant:
            return np.zeros(0)
        allowed = share * float(np.ptp(self.values))
        kept, parts = {0, len(self.values) - 1}, [(0, len(self.values) - 1)]
        while parts:
            first, last = parts.pop()
            ends = [first, last]
            inside = slice(first, last + 1)
            line = np.interp(self.arguments[inside], self.arguments[ends], self.values[ends])
            off = np.abs(self.values[inside] - line)
            worst = first + int(np.argmax(off))
            if off.max() > allowed:
                kept.add(worst)
                parts += [(first, worst), (worst, last)]
        return np.asarray(self.arguments[sorted(kept)])

    def derivative(self, argument: Any) -> FloatArray:
        """Return the slopes at arguments, zero outside; at a point the slope above."""
        slopes = np.concatenate(([0.0], np.diff(self.values) / np.diff(self.arguments), [0.0]))
        return np.asarray(slopes[np.searchsorted(self.arguments, argument, side="right")])
