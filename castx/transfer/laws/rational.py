"""Gap heat law `rational`: the coefficient falls with the square of the gap, level at closure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

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

HALF_GAP: HeatKey[float] = HeatKey(
    "half_gap",
    "gap g0 at which half of the coefficient is left",
    Quantity(LENGTH, above=0.0),
    usual=(1e-5, 5e-4),
)


@dataclass(frozen=True)
class RationalLaw:
    """Coefficient that falls with the square of the gap: h = closed/(1 + (g/g0)²) + h(p).

    An empirical fit to coefficients measured over the gap. Its slope over the gap is zero at
    closure, so that a gap that just opens changes nothing; in wide gaps it tends to zero as 1/g²,
    where the gas would still conduct k/g.

    Attributes:
        closed: coefficient of touching surfaces [W/m²/K].
        half_gap: g0 [m].
        pressure: what contact pressure adds.
        needs_solid_fraction: never.
    """

    closed: Coefficient
    half_gap: float
    pressure: PressureTerm | None = None
    needs_solid_fraction: Literal[False] = False

    def __call__(self, state: PairState, faces: Faces) -> Conductance:
        """Return the conductance of pairs."""
        share = Dual.constant(1.0 / (1.0 + (state.gap / self.half_gap) ** 2), VARIABLES)
        return under_pressure(self.closed(state, faces) * share, self.pressure, state, faces)


def build(given: Given) -> RationalLaw:
    """Return the law of an interface."""
    return RationalLaw(closed_coefficient(given), given.need(HALF_GAP), pressure_term(given))


LAW = GapHeatLaw(
    name="rational",
    summary="The coefficient falls with the square of the gap, to half of it at a gap g0.",
    formula="h = closed/(1 + (g/g0)²) + (1/R)(p/H_e)^b",
    source="empirical fit to coefficients measured over the gap; no derivation is known to us",
    build=build,
    needed=(CLOSED.varying_over("temperature", "time", "pressure"), HALF_GAP),
    useful=(PRESSURE, GAS_CONDUCTIVITY, *ROUGH, RADIATION),
    follows_gap=True,
)
