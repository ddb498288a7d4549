"""Overstress of a power law, V = resistance Δγ^power, and the key `exponent` of its rate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.input.entries import over_temperature
from castx.input.units import PURE_NUMBER
from castx.materials.rules.key import RuleKey
from castx.materials.rules.overstress import Points

EXPONENT = RuleKey(
    "exponent", "exponent n of the stress", over_temperature(PURE_NUMBER, above=0.0), default=1.0
)


@dataclass(frozen=True, eq=False)
class PowerLaw:
    """V(Δγ) = resistance Δγ^power, see `overstress.Overstress`.

    Attributes:
        resistance: overstress that an increment Δγ = 1 over the step takes [Pa], shape (points,);
            0: the flow does not depend on the rate.
        power: 1/n for a rate in the n-th power of the stress, shape (points,).
    """

    resistance: FloatArray
    power: FloatArray

    @classmethod
    def none(cls, temperature: FloatArray) -> PowerLaw:
        """Return V = 0, flow independent of the rate, in the shape of the temperatures."""
        return cls(np.zeros_like(temperature), np.ones_like(temperature))

    @property
    def modulus(self) -> FloatArray:
        """Slope dV/dΔγ [Pa] at the points where V is linear, shape (points,)."""
        return self.resistance

    @property
    def curved(self) -> BoolArray:
        """Whether V is not linear at a point, shape (points,)."""
        return np.asarray((self.resistance > 0.0) & (self.power != 1.0))

    def __call__(self, increment: FloatArray | float) -> FloatArray:
        """Return V [Pa] at increments Δγ, shape (points,)."""
        return self.resistance * increment**self.power

    def evaluate(self, logarithm: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return V and dV/dy = power V at y = ln Δγ, shape (points,)."""
        overstress = self.resistance * np.exp(self.power * logarithm)
        return overstress, self.power * overstress

    def logarithm(self, stress: FloatArray) -> FloatArray:
        """Return ln Δγ of the increment with V(Δγ) = stress, shape (points,)."""
        return np.asarray(-(np.log(self.resistance) - np.log(stress)) / self.power)

    def logarithm_of_half(self) -> FloatArray:
        """Return ln Δγ of the increment with V(Δγ) = 1/2, shape (points,)."""
        return -np.log(2.0 * self.resistance) / self.power

    def scaled(self, stress: FloatArray, logarithm: FloatArray) -> PowerLaw:
        """Return V/stress as a function of Δγ/exp(logarithm)."""
        ratio = np.log(self.resistance) - np.log(stress)
        return PowerLaw(np.exp(ratio + self.power * logarithm), self.power)

    def at(self, points: Points) -> PowerLaw:
        """Return the overstress of some of the points."""
        return PowerLaw(self.resistance[points], self.power[points])
