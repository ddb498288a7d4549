"""Overstress that drives the flow through its increment over one implicit step.

A flow rule states the rate ε̇ of the equivalent viscoplastic strain as a function of the overstress
f. Over a step Δt the increment is Δγ = ε̇ Δt, and the return mapping needs the inverse: V(Δγ), the
overstress at which Δγ flows within the step, as a function of y = ln Δγ.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol, Self

import numpy as np

from castx.arrays import BoolArray, FloatArray, LongArray

Points = BoolArray | LongArray


class Overstress(Protocol):
    """Overstress V(Δγ) of one step at points; it increases from V(0) = 0."""

    @property
    def modulus(self) -> FloatArray:
        """Slope dV/dΔγ [Pa] at the points where V is linear, shape (points,)."""
        ...

    @property
    def curved(self) -> BoolArray:
        """Whether V is not linear at a point, shape (points,)."""
        ...

    def __call__(self, increment: FloatArray | float) -> FloatArray:
        """Return V [Pa] at increments Δγ, shape (points,)."""
        ...

    def evaluate(self, logarithm: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return V [Pa] and dV/dy at y = ln Δγ, shape (points,)."""
        ...

    def logarithm(self, stress: FloatArray) -> FloatArray:
        """Return ln Δγ of the increment with V(Δγ) = stress [Pa], shape (points,)."""
        ...

    def logarithm_of_half(self) -> FloatArray:
        """Return ln Δγ of the increment with V(Δγ) = 1/2, shape (points,)."""
        ...

    def scaled(self, stress: FloatArray, logarithm: FloatArray) -> Self:
        """Return V/stress as a function of Δγ/exp(logarithm)."""
        ...

    def at(self, points: Points) -> Self:
        """Return the overstress of some of the points."""
        ...


@dataclass(frozen=True, eq=False)
class RateOverstress:
    """Overstress of any flow rule, from its overstress as a function of the rate.

    Attributes:
        stress: function (ln ε̇, *parameters) that returns f [Pa] and df/d(ln ε̇).
        log_rate: its inverse, a function (f, *parameters) that returns ln ε̇.
        parameters: of both functions, each of shape (points,).
        log_rates: ln ε̇ at which Δγ = 1, shape (points,).
        unit: stress that counts as 1 [Pa], shape (points,).
    """

    stress: Callable[..., tuple[FloatArray, FloatArray]]
    log_rate: Callable[..., FloatArray]
    parameters: tuple[FloatArray, ...]
    log_rates: FloatArray
    unit: FloatArray

    @classmethod
    def over_step(
        cls,
        stress: Callable[..., tuple[FloatArray, FloatArray]],
        log_rate: Callable[..., FloatArray],
        parameters: tuple[FloatArray, ...],
        step: float,
    ) -> RateOverstress:
        """Return the overstress over a step Δt [s] of functions as described in the class."""
        one = np.ones_like(parameters[0])
        return cls(stress, log_rate, parameters, -np.log(step) * one, one)

    @property
    def modulus(self) -> FloatArray:
        """Zero: V is nowhere linear."""
        return np.zeros_like(self.unit)

    @property
    def curved(self) -> BoolArray:
        """True at all points."""
        return np.ones(self.unit.shape, dtype=bool)

    def __call__(self, increment: FloatArray | float) -> FloatArray:
        """Return V [Pa] at increments Δγ, shape (points,)."""
        with np.errstate(divide="ignore"):
            return self.evaluate(np.log(increment))[0]

    def evaluate(self, logarithm: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return V and dV/dy at y = ln Δγ, shape (points,)."""
        stress, slope = self.stress(logarithm + self.log_rates, *self.parameters)
        return stress / self.unit, slope / self.unit

    def logarithm(self, stress: FloatArray) -> FloatArray:
        """Return ln Δγ of the increment with V(Δγ) = stress, shape (points,)."""
        return self.log_rate(stress * self.unit, *self.parameters) - self.log_rates

    def logarithm_of_half(self) -> FloatArray:
        """Return ln Δγ of the increment with V(Δγ) = 1/2, shape (points,)."""
        return self.logarithm(np.full_like(self.unit, 0.5))

    def scaled(self, stress: FloatArray, logarithm: FloatArray) -> RateOverstress:
        """Return V/stress as a function of Δγ/exp(logarithm)."""
        return replace(self, log_rates=self.log_rates + logarithm, unit=self.unit * stress)

    def at(self, points: Points) -> RateOverstress:
        """Return the overstress of some of the points."""
        parameters = tuple(values[points] for values in self.parameters)
        return replace(
            self, parameters=parameters, log_rates=self.log_rates[points], unit=self.unit[points]
        )
