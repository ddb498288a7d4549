"""Laws of the heat transfer through contact and gap (Chiumenti, section 9, its min settled)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from castx.arrays import FloatArray
from castx.input.variation import Variation
from castx.transfer.conductance import (
    VARIABLES,
    Conductance,
    ConductionLaw,
    Faces,
    touching,
)
from castx.transfer.duals import Dual
from castx.transfer.pair_state import PairState, Points

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
    """R = R_z/k_gas + R_fixed of touching rough and coated surfaces [m² K/W].

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
    """What contact pressure adds, (1/R)(p/H_e)^b.

    For b < 1 its slope is unbounded at p = 0. Up to `SMALLEST_RELATIVE_PRESSURE` times the hardness
    the law is therefore the straight line that meets it there; rounded, the cubic that leaves p = 0
    with slope zero and goes over into the law with its slope.

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


@dataclass(frozen=True)
class GapLaw:
    """Conduction that depends on gap and contact pressure of each pair.

    Closed: closed + pressure term. Open, with the resistance of the gas layer r = g/k or 1/open(g):
    limited 1/max(1/closed, r); series 1/(1/closed + r); constant: closed, whatever the gap. All
    meet at g = p = 0. The bend of limited, at r = 1/closed, and of series, at g = 0, is rounded
    over the width `transition`, outside of which the law is as it was; at closure the slope is then
    zero on both sides.

    Attributes:
        kind: "limited", "series" or "constant".
        closed: coefficient of touching surfaces [W/m²/K].
        gas: conductivity of the gas in the gap [W/m/K]; None: `open` is given, or kind "constant".
        open: coefficient of the gas layer over the gap [W/m²/K].
        pressure: what contact pressure adds.
        transition: width of gaps over which the bend is rounded [m].
        needs_solid_fraction: never.
    """

    kind: Literal["limited", "series", "constant"]
    closed: Coefficient
    gas: Coefficient | None = None
    open: Coefficient | None = None
    pressure: PressureTerm | None = None
    transition: float = 0.0
    needs_solid_fraction: Literal[False] = False

    def __call__(self, state: PairState, faces: Faces) -> Conductance:
        """Return the conductance of pairs."""
        h = self.closed(state, faces)
        if self.kind != "constant":
            h = self._through_layer(h, state, faces)
        if self.pressure is not None:
            h = h + self.pressure(state, faces)
        return Conductance(h, touching(state))

    def _through_layer(self, closed: Dual, state: PairState, faces: Faces) -> Dual:
        contact = closed.inverse()
        if self.kind == "series":
            gap = rounded_gap(state.gap, self.transition)
            resistance = contact + self._layer(gap, state, faces)
        else:
            layer, half_width = self._layer(state.gap, state, faces), None
            if self.transition > 0.0:
                widths = np.full(len(state.gap), 0.5 * self.transition)
                half_width = self._layer(widths, state, faces).minimum(contact)
            resistance = rounded_maximum(contact, layer, half_width)
        return resistance.inverse()

    def _layer(self, gap: FloatArray, state: PairState, faces: Faces) -> Dual:
        """Return the resistance of the gas layer, zero where pairs are closed [m² K/W]."""
        if self.gas is not None:
            return Dual.constant(gap, VARIABLES) / self.gas(state, faces)
        assert self.open is not None
        return self.open(state, faces).inverse().where(state.gap > 0.0, 0.0)


def rounded_gap(gap: FloatArray, width: float) -> FloatArray:
    """Return the gap, between 0 and the width a cubic with slope zero at closure instead."""
    if width <= 0.0:
        return gap
    s = np.minimum(gap / width, 1.0)
    return np.where(s < 1.0, width * s * s * (2.0 - s), gap)


def rounded_maximum(a: Dual, b: Dual, half_width: Dual | None) -> Dual:
    """Return the larger of two numbers, a parabola where they differ by less than a half width."""
    if half_width is None:
        return a.maximum(b)
    rise = b - a
    inside = np.abs(rise.value) < half_width.value
    safe = half_width.where(half_width.value > 0.0, 1.0)
    bow = (rise + half_width) * (rise + half_width) / (safe * 4.0)
    return (a + bow).where(inside, a.maximum(b))


@dataclass(frozen=True)
class SolidFractionLaw:
    """h = F_S·open + (1 − F_S)·closed, F_S the solid fraction of the whole secondary body.

    For runs without mechanics: the volume that has shrunk stands for the gap (Chiumenti, 9.2).

    Attributes:
        closed: coefficient at the start [W/m²/K].
        open: coefficient of the mean gap at the end [W/m²/K].
        needs_solid_fraction: always.
    """

    closed: Coefficient
    open: Coefficient
    needs_solid_fraction: Literal[True] = True

    def __call__(self, state: PairState, faces: Faces) -> Conductance:
        """Return the conductance of pairs; what `open` passes counts as through the gas."""
        solid = faces.solid_fraction
        contact = (-solid + 1.0) * self.closed(state, faces)
        h = contact + solid * self.open(state, faces)
        return Conductance(h, contact.value / h.value)


@dataclass(frozen=True)
class PatchedLaw:
    """Different laws on parts of an interface.

    Attributes:
        patches: pairs of each part, and its law; every pair is in one.
    """

    patches: Sequence[tuple[Points, ConductionLaw]]

    @property
    def needs_solid_fraction(self) -> bool:
        """Whether one of the laws does."""
        return any(law.needs_solid_fraction for _, law in self.patches)

    def __call__(self, state: PairState, faces: Faces) -> Conductance:
        """Return the conductance of pairs."""
        h = Dual.constant(np.zeros(len(state.gap)), VARIABLES)
        contact = np.zeros(len(state.gap))
        for points, law in self.patches:
            part = law(state.at(points), faces.at(points))
            h.value[points] = part.coefficient.value
            h.slopes[:, points] = part.coefficient.slopes
            contact[points] = part.contact
        return Conductance(h, contact)
