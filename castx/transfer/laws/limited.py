"""Gap heat law `limited`: contact while the gap is narrow, the gas alone when it is wide."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from castx.input.problems import Problem
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
from castx.transfer.gas_layer import ConductingLayer, Layer, TabulatedLayer, rounded_maximum
from castx.transfer.keys import (
    CLOSED,
    COATING,
    CURVED,
    GAS_CONDUCTIVITY,
    OPEN,
    PRESSURE,
    RADIATION,
    ROUGH,
    ROUGHNESS,
    TRANSITION,
)
from castx.transfer.pair_state import PairState
from castx.transfer.surfaces import mean_depth


@dataclass(frozen=True)
class LimitedLaw:
    """The coefficient of the gas layer, at most that of contact: h = min(closed, k/g) + h(p).

    The bend where both are equal is rounded over the width `transition`, outside of which the law
    is as it was; at closure the slope is then zero on both sides.
    Source: M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.2. It prints the
    maximum, and says "limited by": the minimum is meant.

    Attributes:
        closed: coefficient of touching surfaces [W/m²/K].
        layer: gas in the gap.
        pressure: what contact pressure adds.
        transition: width of gaps over which the bend is rounded [m].
        needs_solid_fraction: never.
    """

    closed: Coefficient
    layer: Layer
    pressure: PressureTerm | None = None
    transition: float = 0.0
    needs_solid_fraction: Literal[False] = False

    def __call__(self, state: PairState, faces: Faces) -> Conductance:
        """Return the conductance of pairs."""
        contact = self.closed(state, faces).inverse()
        layer, half_width = self.layer(state.gap, state, faces), None
        if self.transition > 0.0:
            widths = np.full(len(state.gap), 0.5 * self.transition)
            half_width = self.layer(widths, state, faces).minimum(contact)
        resistance = rounded_maximum(contact, layer, half_width)
        return under_pressure(resistance.inverse(), self.pressure, state, faces)


def build(given: Given) -> LimitedLaw:
    """Return the law of an interface."""
    opened = given.get(OPEN)
    layer = (
        ConductingLayer(Varied(given.need(GAS_CONDUCTIVITY)), given.get(CURVED))
        if opened is None
        else TabulatedLayer(Varied(opened))
    )
    closed, term = closed_coefficient(given), pressure_term(given)
    return LimitedLaw(closed, layer, term, given.need(TRANSITION))


def problems(given: Given) -> Iterator[Problem]:
    """Yield a jump of the coefficient at closure."""
    opened = given.get(OPEN)
    if opened is None:
        return
    at_closure, closed = float(opened.table(0.0)), _largest_closed(given)
    if at_closure < closed * (1.0 - 1e-12):
        text = f"{at_closure:g} W/m²/K at gap 0, but closed is {closed:g}"
        yield Problem(("open",), f"{text}: the law would jump; at gap 0 it must not be smaller")


def _largest_closed(given: Given) -> float:
    """Return the largest coefficient of touching surfaces without pressure."""
    closed, gas = given.get(CLOSED), given.get(GAS_CONDUCTIVITY)
    if closed is not None:
        table = closed.table
        return float(table(0.0) if closed.over == "pressure" else table.values.max())
    coating = given.get(COATING)
    fixed = 0.0 if coating is None else coating.resistance
    conductivity = 1.0 if gas is None else gas.table.values.max()
    return 1.0 / (mean_depth(given.get(ROUGHNESS)) / float(conductivity) + fixed)


LAW = GapHeatLaw(
    name="limited",
    summary="The gas layer conducts, at most as well as touching surfaces do.",
    formula="h = min(closed, k/g) + (1/R)(p/H_e)^b",
    source="M. Chiumenti, Thermo-mechanical contact in casting analysis, sections 9.1 and 9.2",
    build=build,
    needed=(CLOSED.varying_over("temperature", "time", "pressure"), GAS_CONDUCTIVITY),
    useful=(OPEN.varying_over("gap"), PRESSURE, TRANSITION, *ROUGH, RADIATION, CURVED),
    instead={OPEN: (GAS_CONDUCTIVITY, TRANSITION)},
    problems=problems,
    follows_gap=True,
)
