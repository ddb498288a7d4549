"""Heat condition `convection`: to surroundings, by a coefficient over time or temperature."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.input.entries import Quantity
from castx.input.units import HEAT_TRANSFER
from castx.input.variation import Variation, Varying
from castx.tables import Table
from castx.transfer.conditions.declaration import HeatConditionKind
from castx.transfer.conditions.keys import AMBIENT
from castx.transfer.declaration import Given, HeatKey

COEFFICIENT: HeatKey[Variation] = HeatKey(
    "coefficient",
    "of convection; instead of time its table may go over the temperature of the film or surface",
    Varying(
        Quantity(HEAT_TRANSFER, least=0.0), ("temperature", "time"), ("film", "surface"), rows=True
    ),
    usual=(5.0, 5000.0),
)


@dataclass(frozen=True)
class Convection:
    """Flux q = h·(T_ambient(t) − T), h over time or temperature.

    The temperature is that of the film, (T + T_ambient)/2, or that of the surface.
    Source: M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.2.

    Attributes:
        coefficient: h [W/m²/K].
        ambient: T_ambient over time [°C].
    """

    coefficient: Variation
    ambient: Table

    def __call__(
        self, start: float, end: float, temperature: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the flux and its derivative."""
        ambient, table = self.ambient.mean(start, end), self.coefficient.table
        if self.coefficient.over == "time":
            h = np.full_like(temperature, table.mean(start, end))
            slope = np.zeros_like(temperature)
        else:
            share = 0.5 if self.coefficient.of == "film" else 1.0
            deciding = share * temperature + (1.0 - share) * ambient
            h, slope = table(deciding), share * table.derivative(deciding)
        return h * (ambient - temperature), slope * (ambient - temperature) - h


def flux(given: Given) -> Convection:
    """Return the law of a surface."""
    return Convection(given.need(COEFFICIENT), given.need(AMBIENT))


CONDITION = HeatConditionKind(
    name="convection",
    summary="A fluid of a given temperature takes heat by a coefficient.",
    formula="q = h·(T_ambient(t) − T)",
    source="M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.2",
    keys=(COEFFICIENT, AMBIENT),
    flux=flux,
)
