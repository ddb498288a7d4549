"""Levels of solid fraction on the enthalpy curve of a material."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from castx.arrays import BoolArray, FloatArray

COLDEST, HOTTEST = -273.15, 1e4
"""Temperatures between which every metal freezes [°C]."""

ROUNDING = 1e-12
"""Difference of solid fraction that counts as none."""


class FreezingCurve(Protocol):
    """The part of a material's enthalpy curve that is needed here."""

    def enthalpy(self, temperature: FloatArray) -> FloatArray:
        """Return enthalpies per volume [J/m³] at temperatures [°C]."""

    def temperature(self, enthalpy: FloatArray) -> FloatArray:
        """Return temperatures [°C] at enthalpies per volume [J/m³]."""

    def solid_fraction(self, enthalpy: FloatArray) -> FloatArray:
        """Return solid fractions at enthalpies per volume [J/m³]."""


@dataclass(frozen=True)
class Level:
    """A solid fraction on the enthalpy curve of a material.

    Attributes:
        temperature: at which it is reached [°C].
        cold, hot: enthalpies at the ends of the plateau of this temperature [J/m³], equal if there
            is none.
    """

    temperature: float
    cold: float
    hot: float

    @classmethod
    def of(cls, curve: FreezingCurve, fraction: float) -> Level:
        """Return the level of a solid fraction; 0 is the liquidus, 1 the solidus."""
        least = max(min(fraction, 1.0 - ROUNDING), ROUNDING)
        reached = highest(curve, lambda enthalpy: curve.solid_fraction(enthalpy) >= least)
        temperature = float(curve.temperature(np.array(reached)))
        return cls.at(curve, temperature)

    @classmethod
    def at(cls, curve: FreezingCurve, temperature: float) -> Level:
        """Return the level of a temperature [°C] between solidus and liquidus."""
        cold = highest(curve, lambda enthalpy: curve.temperature(enthalpy) < temperature)
        hot = highest(curve, lambda enthalpy: curve.temperature(enthalpy) <= temperature)
        return cls(temperature, cold, hot)

    def enthalpy_beside(
        self, curve: FreezingCurve, temperature: FloatArray, distance: FloatArray
    ) -> FloatArray:
        """Return enthalpies of points beside a front [J/m³].

        Args:
            curve: of the material.
            temperature: of the points [°C].
            distance: from the front, positive ahead of it; it decides at the front's temperature.
        """
        enthalpy = curve.enthalpy(temperature)
        hotter = (temperature > self.temperature) | (
            (temperature == self.temperature) & (distance > 0.0)
        )
        return np.where(hotter, np.maximum(enthalpy, self.hot), np.minimum(enthalpy, self.cold))


def highest(curve: FreezingCurve, holds: Callable[[FloatArray], BoolArray]) -> float:
    """Return the highest enthalpy [J/m³] up to which something holds, by bisection."""
    low, high = (float(curve.enthalpy(np.array(bound))) for bound in (COLDEST, HOTTEST))
    while (middle := 0.5 * (low + high)) not in (low, high):
        low, high = (middle, high) if bool(holds(np.array(middle))) else (low, middle)
    return low
