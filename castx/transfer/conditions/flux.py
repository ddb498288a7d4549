"""Heat condition `flux`: the heat flux is given over time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.input.entries import over_time
from castx.input.units import HEAT_FLUX
from castx.tables import Table
from castx.transfer.conditions.declaration import HeatConditionKind
from castx.transfer.declaration import Given, HeatKey

VALUE: HeatKey[Table] = HeatKey(
    "value", "heat flux into the body", over_time(HEAT_FLUX), usual=(1e3, 1e6)
)


@dataclass(frozen=True)
class GivenFlux:
    """Flux q = value(t), whatever the temperature of the surface.

    Attributes:
        value: q over time [W/m²].
    """

    value: Table

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
    formula="q = value(t)",
    source="H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids (1959), section 1.9",
    keys=(VALUE,),
    flux=flux,
)
