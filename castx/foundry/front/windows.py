"""The part of a step in which a node freezes from one solid fraction to another."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.front.levels import FreezingCurve, highest


@dataclass(frozen=True)
class Window:
    """A range of solid fractions, by a quantity that falls while a node freezes.

    Attributes:
        begin: value at which the lower solid fraction is reached, enthalpy [J/m³] or temperature
            [°C].
        end: value at which the higher one is reached, below `begin`.
    """

    begin: float
    end: float

    @classmethod
    def of_enthalpies(cls, curve: FreezingCurve, low: float, high: float) -> Window:
        """Return the range between two solid fractions by the enthalpy of a node."""
        return cls(*(enthalpy_at(curve, fraction) for fraction in (low, high)))

    @classmethod
    def of_temperatures(cls, curve: FreezingCurve, low: float, high: float) -> Window:
        """Return the same by its temperature, for bodies whose temperature is prescribed."""
        found = cls.of_enthalpies(curve, low, high)
        begin, end = (float(curve.temperature(np.array(h))) for h in (found.begin, found.end))
        return cls(begin, end)

    def share(self, start: FloatArray, end: FloatArray) -> FloatArray:
        """Return the share of a step that nodes spend in the range, at an even rate, (nodes,).

        Args:
            start: values of the nodes at the start of the step, (nodes,).
            end: at its end.
        """
        low, high = np.minimum(start, end), np.maximum(start, end)
        inside = np.clip(high, self.end, self.begin) - np.clip(low, self.end, self.begin)
        resting = ((start >= self.end) & (start < self.begin)).astype(np.float64)
        return np.asarray(np.divide(inside, high - low, out=resting, where=high > low))

    def enters(self, start: FloatArray, end: FloatArray) -> FloatArray:
        """Return whether nodes come from the liquid into the range, or through it, (nodes,)."""
        return np.asarray((start >= self.begin) & (end < self.begin))


def enthalpy_at(curve: FreezingCurve, fraction: float) -> float:
    """Return the enthalpy at which a solid fraction is reached on cooling [J/m³]."""
    return highest(curve, lambda enthalpy: curve.solid_fraction(enthalpy) >= fraction)
