"""Numbers of gap heat laws at the pairs: coefficients that vary, resistances, pressure terms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from castx.arrays import FloatArray
from castx.input.variation import Variation
from castx.transfer.conductance import VARIABLES, Conductance, Faces, touching
from castx.transfer.declaration import Given
from castx.transfer.duals import Dual
from castx.transfer.keys import (
    CLOSED,
    COATING,
    GAS_CONDUCTIVITY,
    PRESSURE,
    ROUGHNESS,
    TRANSITION,
)
from castx.transfer.pair_state import PairState
from castx.transfer.surfaces import Coating, mean_depth

SMALLEST_RELATIVE_PRESSURE = 1e-6
"""Pressure over hardness below which the pressure law is regularised: for an exponent below 1 its
slope is unbounded at p = 0."""


class Coefficient(Protocol):
    """A number of a law at the pairs."""

    def __call__(self, state: PairState, faces: Faces) -> Dual:
        """Return the values, shape (pairs,)."""


@dataclass(frozen=True)
class Varied:
    """A coefficient that is constant or varies with one quantity."""

    variation: Variation

    def __call__(self, state: PairState, faces: Faces) -> Dual:
        """Return the values, shape (pairs,)."""
        table, over = self.variation.table, self.variation.over
        if over == "temperature":
            temperature = faces.temperature(self.variation.of)
            return temperature.through(table, table.derivative)
        if over == "time":
            return Dual.constant(np.full(len(state.gap), table(faces.time)), VARIABLES)
        return Dual.constant(table(state.gap if over == "gap" else state.pressure), VARIABLES)


@dataclass(frozen=True)
class ContactResistance:
    """Resistance R = R_z/k_gas + δ/k_coat of touching rough and coated surfaces [m² K/W].

    Source: M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.1.

    Attributes:
        fixed: of the coating, δ/k, or as measured [m² K/W].
        depth: R_z, mean depth of the roughness [m].
        gas: conductivity of the gas in it; needed with a depth [W/m/K].
    """

    fixed: float
    depth: float = 0.0
    gas: Coefficient | None = None

    def __call__(self, state: PairState, faces: Faces) -> Dual:
        """Return R, shape (pairs,)."""
        fixed = Dual.constant(np.full(len(state.gap), self.fixed), VARIABLES)
        if self.gas is None:
            return fixed
        return Dual.constant(self.depth, VARIABLES) / self.gas(state, faces) + fixed


@dataclass(frozen=True)
class Inverse:
    """The coefficient 1/R of a resistance."""

    resistance: ContactResistance

    def __call__(self, state: PairState, faces: Faces) -> Dual:
        """Return 1/R, shape (pairs,)."""
        return self.resistance(state, faces).inverse()


@dataclass(frozen=True)
class PressureTerm:
    """Coefficient that contact pressure adds, h(p) = (1/R)(p/H_e)^b.

    For b < 1 its slope is unbounded at p = 0. Up to `SMALLEST_RELATIVE_PRESSURE` times the hardness
    the law is therefore the straight line that meets it there; rounded, the cubic that leaves p = 0
    with slope zero and goes over into the law with its slope.
    Source: M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.1.

    Attributes:
        resistance: R.
        hardness: H_e [Pa].
        exponent: b.
        rounded: whether the slope is continuous.
    """

    resistance: ContactResistance
    hardness: float
    exponent: float
    rounded: bool = False

    def __call__(self, state: PairState, faces: Faces) -> Dual:
        """Return the added coefficient [W/m²/K], shape (pairs,)."""
        power = Dual.constant(self.power(state.pressure), VARIABLES)
        return power / self.resistance(state, faces)

    def power(self, pressure: FloatArray) -> FloatArray:
        """Return (p/H_e)^b, regularised."""
        b, relative = self.exponent, pressure / self.hardness
        if b > 1.0 or (b == 1.0 and not self.rounded):
            return relative**b
        s = np.minimum(relative / SMALLEST_RELATIVE_PRESSURE, 1.0)
        start = s * s * ((3.0 - b) - (2.0 - b) * s) if self.rounded else s
        law = np.maximum(relative, SMALLEST_RELATIVE_PRESSURE) ** b
        return np.asarray(start * law)


def under_pressure(
    h: Dual, pressure: PressureTerm | None, state: PairState, faces: Faces
) -> Conductance:
    """Return the conductance of pairs to whose coefficient contact pressure adds.

    Args:
        h: coefficient without pressure [W/m²/K].
        pressure: what is added; None: nothing.
        state: of the pairs.
        faces: of the pairs.
    """
    if pressure is not None:
        h = h + pressure(state, faces)
    return Conductance(h, touching(state))


def closed_coefficient(given: Given) -> Coefficient:
    """Return the coefficient of touching surfaces: as given, or 1/R of roughness and coating."""
    closed = given.get(CLOSED)
    if closed is not None:
        return Varied(closed)
    return Inverse(_resistance(given, given.get(ROUGHNESS), given.get(COATING)))


def pressure_term(given: Given) -> PressureTerm | None:
    """Return the pressure term of a coefficient; None where nothing is given."""
    term = given.get(PRESSURE)
    if term is None:
        return None
    if term.resistance is not None:
        resistance = ContactResistance(term.resistance)
    elif term.rough:
        resistance = _resistance(given, term.roughness, term.coating)
    else:
        resistance = _resistance(given, given.get(ROUGHNESS), given.get(COATING))
    return PressureTerm(resistance, term.hardness, term.exponent, given.need(TRANSITION) > 0.0)


def _resistance(
    given: Given, roughness: tuple[float, ...] | None, coating: Coating | None
) -> ContactResistance:
    fixed = 0.0 if coating is None else coating.resistance
    gas = given.get(GAS_CONDUCTIVITY)
    varied = None if roughness is None or gas is None else Varied(gas)
    return ContactResistance(fixed, mean_depth(roughness), varied)
