"""Numbers that carry their derivatives along (dual numbers, forward differentiation).

Source: A. Griewank, A. Walther, Evaluating Derivatives (2008), chapter 3.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from castx.arrays import BoolArray, FloatArray

Function = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True)
class Dual:
    """Values at points and their derivatives over some variables.

    Args:
        value: shape (points,).
        slopes: derivatives, shape (variables, points).
    """

    value: FloatArray
    slopes: FloatArray

    @classmethod
    def constant(cls, value: npt.ArrayLike, variables: int) -> Dual:
        """Return values (points,), or one for all points, that depend on nothing."""
        array = np.atleast_1d(np.asarray(value, dtype=np.float64))
        return cls(array, np.zeros((variables, len(array))))

    @classmethod
    def variable(cls, value: npt.ArrayLike, number: int, variables: int) -> Dual:
        """Return the values (points,) of one of the variables."""
        dual = cls.constant(value, variables)
        dual.slopes[number] = 1.0
        return dual

    def _with(self, other: Dual | npt.ArrayLike) -> Dual:
        return other if isinstance(other, Dual) else Dual.constant(other, len(self.slopes))

    def __add__(self, other: Dual | npt.ArrayLike) -> Dual:
        """Return the sum."""
        b = self._with(other)
        return Dual(self.value + b.value, self.slopes + b.slopes)

    def __neg__(self) -> Dual:
        """Return the opposite."""
        return Dual(-self.value, -self.slopes)

    def __sub__(self, other: Dual | npt.ArrayLike) -> Dual:
        """Return the difference."""
        return self + -self._with(other)

    def __mul__(self, other: Dual | npt.ArrayLike) -> Dual:
        """Return the product."""
        b = self._with(other)
        return Dual(self.value * b.value, self.slopes * b.value + self.value * b.slopes)

    def __truediv__(self, other: Dual | npt.ArrayLike) -> Dual:
        """Return the quotient."""
        b = self._with(other)
        quotient = self.value / b.value
        return Dual(quotient, (self.slopes - quotient * b.slopes) / b.value)

    def inverse(self) -> Dual:
        """Return the reciprocals of these numbers."""
        inverse = np.asarray(1.0 / self.value)
        return Dual(inverse, -inverse * inverse * self.slopes)

    def through(self, function: Function, slope: Function) -> Dual:
        """Return a function of the values.

        Args:
            function: of values (points,).
            slope: its derivative.
        """
        return Dual(function(self.value), slope(self.value) * self.slopes)

    def where(self, condition: BoolArray, other: Dual | npt.ArrayLike) -> Dual:
        """Return these numbers where a condition (points,) holds, others elsewhere."""
        b = self._with(other)
        return Dual(
            np.where(condition, self.value, b.value), np.where(condition, self.slopes, b.slopes)
        )

    def minimum(self, other: Dual | npt.ArrayLike) -> Dual:
        """Return the smaller of two numbers, these where they are equal."""
        b = self._with(other)
        return self.where(self.value <= b.value, b)

    def maximum(self, other: Dual | npt.ArrayLike) -> Dual:
        """Return the larger of two numbers, these where they are equal."""
        b = self._with(other)
        return self.where(self.value >= b.value, b)

    def at(self, points: npt.NDArray[np.intp]) -> Dual:
        """Return the numbers at some of the points."""
        return Dual(self.value[points], self.slopes[:, points])
