"""Resistance of the gas layer in an open gap, and roundings of its bends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from castx.arrays import FloatArray
from castx.transfer.coefficients import Coefficient
from castx.transfer.conductance import VARIABLES, Faces
from castx.transfer.duals import Dual
from castx.transfer.pair_state import PairState
from castx.transfer.surfaces import CurvedGap


class Layer(Protocol):
    """A gas layer between surfaces."""

    def __call__(self, gap: FloatArray, state: PairState, faces: Faces) -> Dual:
        """Return the resistance across gaps [m], shape (pairs,) [m² K/W]; zero where closed."""


@dataclass(frozen=True)
class ConductingLayer:
    """Gas that conducts, r = g/k.

    Source: M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.2.

    Attributes:
        gas: conductivity k [W/m/K].
        curved: gap between cylinders or spheres; None: plane.
    """

    gas: Coefficient
    curved: CurvedGap | None = None

    def __call__(self, gap: FloatArray, state: PairState, faces: Faces) -> Dual:
        """Return the resistance across gaps [m² K/W]."""
        thickness = gap if self.curved is None else self.curved.thickness(gap)
        return Dual.constant(thickness, VARIABLES) / self.gas(state, faces)


@dataclass(frozen=True)
class TabulatedLayer:
    """A layer whose coefficient is tabulated over the gap, r = 1/h(g).

    Attributes:
        coefficient: h over the gap of the state [W/m²/K].
    """

    coefficient: Coefficient

    def __call__(self, gap: FloatArray, state: PairState, faces: Faces) -> Dual:
        """Return the resistance at the gaps of the state [m² K/W], infinite where h = 0."""
        h = self.coefficient(state, faces)
        passes = h.value > 0.0
        resistance = h.where(passes, 1.0).inverse().where(passes, np.inf)
        return resistance.where(state.gap > 0.0, 0.0)


def rounded_gap(gap: FloatArray, width: float) -> FloatArray:
    """Return the gap, replaced up to a width by a cubic with slope zero at closure [m]."""
    if width <= 0.0:
        return gap
    s = np.minimum(gap / width, 1.0)
    return np.where(s < 1.0, width * s * s * (2.0 - s), gap)


def rounded_maximum(a: Dual, b: Dual, half_width: Dual | None) -> Dual:
    """Return the larger of two numbers, rounded by a parabola where they nearly meet.

    Args:
        a: numbers at the pairs.
        b: others.
        half_width: largest difference that is rounded; None: nothing is.
    """
    if half_width is None:
        return a.maximum(b)
    rise = b - a
    inside = np.abs(rise.value) < half_width.value
    safe = half_width.where(half_width.value > 0.0, 1.0)
    bow = (rise + half_width) * (rise + half_width) / (safe * 4.0)
    return (a + bow).where(inside, a.maximum(b))
