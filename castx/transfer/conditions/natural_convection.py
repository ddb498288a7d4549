"""Heat condition `natural-convection`: still air along a vertical wall, laminar."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.input.entries import Quantity
from castx.input.units import LENGTH
from castx.tables import Table
from castx.transfer.conditions.declaration import HeatConditionKind
from castx.transfer.conditions.keys import AMBIENT
from castx.transfer.declaration import Given, HeatKey

COEFFICIENT = 1.42
"""Of air at atmospheric pressure [W/m²/K (m/K)^¼]."""

HEIGHT: HeatKey[float] = HeatKey(
    "height", "height L of the wall", Quantity(LENGTH, above=0.0), usual=(0.05, 1.0)
)


@dataclass(frozen=True)
class NaturalConvection:
    """Flux q = −h ΔT with h = 1.42 (|ΔT|/L)^¼ and ΔT = T − T_ambient(t), mean over the wall.

    For air and 10⁴ < Gr Pr < 10⁹, which is a height of about half a metre at most.

    Attributes:
        height: L [m].
        ambient: T_ambient over time [°C].
    """

    height: float
    ambient: Table

    def __call__(
        self, start: float, end: float, temperature: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the flux and its derivative −(5/4) h."""
        excess = temperature - self.ambient.mean(start, end)
        h = COEFFICIENT * (np.abs(excess) / self.height) ** 0.25
        return -h * excess, -1.25 * h


def flux(given: Given) -> NaturalConvection:
    """Return the law of a surface."""
    return NaturalConvection(given.need(HEIGHT), given.need(AMBIENT))


CONDITION = HeatConditionKind(
    name="natural-convection",
    summary="Still air cools or warms a vertical wall, in laminar flow.",
    formula="q = −h ΔT with h = 1.42 (|ΔT|/L)^¼, ΔT = T − T_ambient(t)",
    source="W. H. McAdams, Heat Transmission (1954), chapter 7, and in SI J. P. Holman, Heat "
    "Transfer, table 7-2: simplified equations for air",
    keys=(HEIGHT, AMBIENT),
    flux=flux,
)
