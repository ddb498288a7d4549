"""A property that differs between solid and liquid, blended by the solid fraction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.tables import Table


@dataclass(frozen=True, eq=False)
class Phased:
    """Property f_s·solid(T) + (1 − f_s)·liquid(T)."""

    solid: Table
    liquid: Table

    @classmethod
    def uniform(cls, table: Table) -> Phased:
        """Return the property that both phases share."""
        return cls(table, table)

    def __call__(self, temperature: Any, solid_fraction: Any) -> FloatArray:
        """Return the blended values, in the common shape of the arguments [°C, 1]."""
        if self.solid is self.liquid:
            shape = np.broadcast(temperature, solid_fraction).shape
            return np.broadcast_to(self.solid(temperature), shape)
        return np.asarray(
            solid_fraction * self.solid(temperature)
            + (1.0 - np.asarray(solid_fraction)) * self.liquid(temperature)
        )
