"""A body of one temperature that cools through its surface: h from samples.

The smallest model of an interface: use it to see how good an identified coefficient can be at all,
before sensors are placed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.identification.covariance import posterior


@dataclass(frozen=True)
class LumpedCooling:
    """Cooling T = T_a + (T_0 - T_a) exp(-h t/C).

    Attributes:
        capacity: C per area of the surface [J/m²/K].
        coefficient: h [W/m²/K].
        start: T_0 [°C].
        ambient: T_a [°C].
    """

    capacity: float
    coefficient: float
    start: float
    ambient: float

    def temperature(self, time: FloatArray) -> FloatArray:
        """Return temperatures [°C] at times [s]."""
        return self.ambient + (self.start - self.ambient) * self._left(time)

    def _left(self, time: FloatArray) -> FloatArray:
        return np.asarray(np.exp(-self.coefficient * np.asarray(time) / self.capacity))

    def sensitivity(self, time: FloatArray) -> FloatArray:
        """Return changes by ln h and by T_0 [K and 1], (times, 2)."""
        left, number = self._left(time), self.coefficient * np.asarray(time) / self.capacity
        return np.column_stack([-(self.start - self.ambient) * number * left, left])

    def covariance(self, time: FloatArray, noise: float, start_known: bool = True) -> FloatArray:
        """Return the covariance of ln h, and of T_0 unless it is known.

        Args:
            time: of the samples [s].
            noise: standard deviation of each [K].
            start_known: whether T_0 is not fitted.
        """
        changes = self.sensitivity(time)
        return posterior(changes[:, :1] if start_known else changes, np.array(noise))

    @property
    def best_time(self) -> float:
        """Time at which one sample is most sensitive to h, C/h [s]."""
        return self.capacity / self.coefficient
