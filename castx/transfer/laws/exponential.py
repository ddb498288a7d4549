"""Gap heat law `exponential`: the coefficient decays with the gap over a length of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from castx.input.entries import Quantity
from castx.input.units import LENGTH
from castx.transfer.coefficients import (
    Coefficient,
    PressureTerm,
    closed_coefficient,
    pressure_term,
    under_pressure,
)
from castx.transfer.conductance import VARIABLES, Conductance, Faces
from castx.transfer.declaration import GapHeatLaw, Given, HeatKey
from castx.transfer.duals import Dual
from castx.transfer.keys import CLOSED, GAS_CONDUCTIVITY, PRESSURE, RADIATION, ROUGH
from castx.transfer.pair_state import PairState

DECAY_LENGTH: HeatKey[float] = HeatKey(
    "decay_length",
    "gap g0 over which the coefficient falls to 1/e",
    Quantity(LENGTH, above=0.0),
    usual=(2e-5, 5e-4),
)


@dataclass(frozen=True)
class ExponentialLaw:
    """Coefficient that decays with the gap: h = closed·exp(−g/g0) + h(p).

    An empirical fit to coefficients measured over the gap; it tends to zero in wide gaps, where the
    gas would still conduct k/g.

    Attributes:
        closed: coefficient of touching surfaces [W/m²/K].
        decay_length: g0 [m].
        pressure: what contact pressure adds.
        needs_solid_fraction: never.
    """

    closed: Coefficient
    decay_length: float
    pressure: PressureTerm | None = None
    needs_solid_fraction: Literal[False] = False

    def __call__(self, state: PairState, faces: Faces) -> Conductance:
        """Return the conductance of pairs."""
        decay = Dual.constant(np.exp(-state.gap / self.decay_length), VARIABLES)
        return under_pressure(self.closed(state, faces) * decay, self.pressure, state, faces)


def build(given: Given) -> ExponentialLaw:
    """Return the law of an interface."""
    length = given.need(DECAY_LENGTH)
    return ExponentialLaw(closed_coefficient(given), length, pressure_term(given))


LAW = GapHeatLaw(
    name="exponential",
    summary="The coefficient decays with the gap, by 1/e over a length g0.",
    formula="h = closed·exp(−g/g0) + (1/R)(p/H_e)^b",
    source="empirical fit to coefficients measured over the gap; no derivation is known to us",
    build=build,
    needed=(CLOSED.varying_over("temperature", "time", "pressure"), DECAY_LENGTH),
    useful=(PRESSURE, GAS_CONDUCTIVITY, *ROUGH, RADIATION),
    follows_gap=True,
)
