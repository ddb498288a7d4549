"""Gap heat law `series`: the resistances of contact and gas layer add up."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from castx.transfer.coefficients import (
    Coefficient,
    PressureTerm,
    Varied,
    closed_coefficient,
    pressure_term,
    under_pressure,
)
from castx.transfer.conductance import Conductance, Faces
from castx.transfer.declaration import GapHeatLaw, Given
from castx.transfer.gas_layer import ConductingLayer, rounded_gap
from castx.transfer.keys import (
    CLOSED,
    CURVED,
    GAS_CONDUCTIVITY,
    PRESSURE,
    RADIATION,
    ROUGH,
    TRANSITION,
)
from castx.transfer.pair_state import PairState


@dataclass(frozen=True)
class SeriesLaw:
    """Contact and gas layer one behind the other: h = 1/(1/closed + g/k) + h(p).

    The bend at closure is rounded over the width `transition`, outside of which the law is as it
    was; at closure the slope is then zero on both sides.

    Attributes:
        closed: coefficient of touching surfaces [W/m²/K].
        layer: gas in the gap.
        pressure: what contact pressure adds.
        transition: width of gaps over which the bend is rounded [m].
        needs_solid_fraction: never.
    """

    closed: Coefficient
    layer: ConductingLayer
    pressure: PressureTerm | None = None
    transition: float = 0.0
    needs_solid_fraction: Literal[False] = False

    def __call__(self, state: PairState, faces: Faces) -> Conductance:
        """Return the conductance of pairs."""
        contact = self.closed(state, faces).inverse()
        gap = rounded_gap(state.gap, self.transition)
        resistance = contact + self.layer(gap, state, faces)
        return under_pressure(resistance.inverse(), self.pressure, state, faces)


def build(given: Given) -> SeriesLaw:
    """Return the law of an interface."""
    layer = ConductingLayer(Varied(given.need(GAS_CONDUCTIVITY)), given.get(CURVED))
    closed, term = closed_coefficient(given), pressure_term(given)
    return SeriesLaw(closed, layer, term, given.need(TRANSITION))


LAW = GapHeatLaw(
    name="series",
    summary="The resistances of touching surfaces and of the gas layer add up.",
    formula="h = 1/(1/closed + g/k) + (1/R)(p/H_e)^b",
    source="resistances in series; 1/closed and k/g as in M. Chiumenti, Thermo-mechanical contact "
    "in casting analysis, sections 9.1 and 9.2",
    build=build,
    needed=(CLOSED.varying_over("temperature", "time", "pressure"), GAS_CONDUCTIVITY),
    useful=(PRESSURE, TRANSITION, *ROUGH, RADIATION, CURVED),
    follows_gap=True,
)
