"""Heat condition `radiation`: a grey surface and large surroundings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.input.entries import over_time
from castx.input.units import PURE_NUMBER
from castx.tables import Table
from castx.transfer.conditions.declaration import HeatConditionKind
from castx.transfer.conditions.keys import AMBIENT
from castx.transfer.declaration import Given, HeatKey
from castx.transfer.radiation import emission

EMISSIVITY: HeatKey[Table] = HeatKey(
    "emissivity",
    "of the surface",
    over_time(PURE_NUMBER, above=0.0, most=1.0),
    usual=(0.2, 0.9),
)


@dataclass(frozen=True)
class SurfaceRadiation:
    """Flux q = ε(t) σ (T_ambient⁴ − T⁴) from large surroundings, T absolute.

    Source: M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.3.

    Attributes:
        emissivity: ε over time.
        ambient: T_ambient over time [°C].
    """

    emissivity: Table
    ambient: Table

    def __call__(
        self, start: float, end: float, temperature: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the flux and its derivative."""
        emissivity = self.emissivity.mean(start, end)
        received, _ = emission(np.asarray(self.ambient.mean(start, end)))
        emitted, slope = emission(temperature)
        return emissivity * (received - emitted), -emissivity * slope


def flux(given: Given) -> SurfaceRadiation:
    """Return the law of a surface."""
    return SurfaceRadiation(given.need(EMISSIVITY), given.need(AMBIENT))


CONDITION = HeatConditionKind(
    name="radiation",
    summary="A grey surface radiates to large surroundings of a given temperature.",
    formula="q = ε(t) σ (T_ambient⁴ − T⁴)",
    source="M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.3",
    keys=(EMISSIVITY, AMBIENT),
    flux=flux,
)
