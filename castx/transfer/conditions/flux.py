"""Heat condition `flux`: the heat flux is given over time, and may vary from place to place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.input.entries import Quantity
from castx.input.located import OverTime
from castx.input.placed import PlacedOverTime
from castx.input.units import HEAT_FLUX
from castx.transfer.conditions.declaration import HeatConditionKind
from castx.transfer.declaration import Given, HeatKey

VALUE: HeatKey[OverTime] = HeatKey(
    "value", "heat flux into the body", PlacedOverTime(Quantity(HEAT_FLUX)), usual=(1e3, 1e6)
)


@dataclass(frozen=True)
class GivenFlux:
    """Flux q = value(x, t), whatever the temperature of the surface.

    Attributes:
        value: q over time [W/m²].
    """

    value: OverTime

    def __call__(
        self, start: float, end: float, temperature: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the flux and its zero derivative."""
        return np.full_like(temperature, self.value.mean(start, end)), np.zeros_like(temperature)


def flux(given: Given) -> GivenFlux:
    """Return the law of a surface."""
    return GivenFlux(given.need(VALUE))


CONDITION = HeatConditionKind(
    name="flux",
    summary="A given heat flux enters the body.",
    formula="q = value(x, t)",
    source="H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids (1959), section 1.9",
    keys=(VALUE,),
    flux=flux,
)
