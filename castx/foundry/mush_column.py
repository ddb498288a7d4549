"""Suction along a column of mush whose root is shut and whose other end is fed.

Melt follows what the skeleton loses by freezing and by being stretched,
    dw/dx = -(β ∂f/∂t + (1 + β f) ∂ε/∂t),   w = (K/μ) dp/dx,   w = 0 at the root,
with the permeability of Kozeny and Carman, K = λ2² g³/(180 f²), g = 1 - f, below the cut-off g_c
that of g_c. The mean of K over an element is that of a flow that grows with g,
    1/K_mean = ⟨g/K⟩/⟨g⟩, f linear in the element,
so that flow driven by even freezing has exact pressures at the nodes of any mesh.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.porosity import KOZENY_CARMAN, Melt

EVEN = 1e-3
"""Difference of liquid fractions below which a mean is taken by Gauss's rule, not by primitives."""


@dataclass(frozen=True)
class MushResistance:
    """Resistance of a mush to the flow of melt.

    Attributes:
        melt: viscosity, contraction by freezing; its cavitation is not used here.
        arm_spacing: λ2 [m].
        cut_off: g_c, the smallest liquid fraction of the permeability.
        least_solid: smallest solid fraction of the permeability; 0: pure liquid has no resistance.
    """

    melt: Melt
    arm_spacing: float
    cut_off: float
    least_solid: float = 0.0

    def permeability(self, liquid: FloatArray) -> FloatArray:
        """Return K = λ2² g³/(180 (1-g)²) [m²], infinite in pure liquid without `least_solid`.

        Args:
            liquid: g, of any shape; below g_c K is that of g_c.
        """
        g = np.maximum(np.asarray(liquid, dtype=np.float64), self.cut_off)
        solid = np.maximum(1.0 - g, self.least_solid)
        with np.errstate(divide="ignore"):
            return np.asarray(self.arm_spacing**2 * g**3 / (KOZENY_CARMAN * solid**2))

    def mean_resistance(self, start: FloatArray, end: FloatArray) -> FloatArray:
        """Return 1/K_mean = ⟨g/K⟩/⟨g⟩ of elements whose g goes evenly from start to end [1/m²].

        Args:
            start: g at one end, (elements,).
            end: at the other.
        """
        drag, middle = self.drag(start, end), 0.5 * (start + end)
        solid = (1.0 - self.cut_off) ** 2 / self.cut_off**3  # what it is below the cut-off
        ratio = np.divide(drag, middle, out=np.full_like(middle, solid), where=middle > 0.0)
        return np.asarray(KOZENY_CARMAN / self.arm_spacing**2 * ratio)

    def drag(self, start: FloatArray, end: FloatArray) -> FloatArray:
        """Return ⟨g/K⟩ λ2²/180 where g goes evenly from start to end, of any shape."""
        low, high = np.minimum(start, end), np.maximum(start, end)
        width = high - low
        primitive = self._primitive(high) - self._primitive(low)
        flat = width < EVEN
        return np.asarray(
            np.divide(primitive, width, out=self._by_points(low, high), where=~flat)
        )

    def _primitive(self, g: FloatArray) -> FloatArray:
        """Return ∫ g f²/x³ dg from the cut-off, x = max(g, g_c), f = max(1-x, `least_solid`)."""
        cut, thin = self.cut_off, 1.0 - self.least_solid

        def mush(g: FloatArray) -> FloatArray:
            return np.asarray(g - 2.0 * np.log(g) - 1.0 / g)

        beyond = mush(np.clip(g, cut, thin)) - mush(np.array(cut))
        below = 0.5 * (np.minimum(g, cut) ** 2 - cut**2) * (1.0 - cut) ** 2 / cut**3
        liquid = self.least_solid**2 * (1.0 / thin - 1.0 / np.maximum(g, thin))
        return np.asarray(beyond + below + liquid)

    def _by_points(self, low: FloatArray, high: FloatArray) -> FloatArray:
        """Return ⟨g f²/x³⟩ by Gauss's rule, valid for equal ends too."""
        points, weights = np.polynomial.legendre.leggauss(5)
        g = low[..., None] + (high - low)[..., None] * 0.5 * (points + 1.0)
        x = np.maximum(g, self.cut_off)
        solid = np.maximum(1.0 - x, self.least_solid)
        return np.asarray(0.5 * (g * solid**2 / x**3) @ weights)


def column_suction(
    positions: FloatArray,
    solid_fraction: FloatArray,
    freezing_rate: FloatArray,
    stretching_rate: FloatArray,
    mush: MushResistance,
) -> FloatArray:
    """Return the suction at the nodes of a column [Pa], zero at its fed end, (nodes,).

    Linear elements; solid fraction and rates go evenly from node to node.

    Args:
        positions: of the nodes from the shut root to the fed end, rising, (nodes,) [m].
        solid_fraction: f there.
        freezing_rate: ∂f/∂t there [1/s].
        stretching_rate: rate of the volumetric strain of the skeleton there [1/s].
        mush: resistance.
    """
    beta = mush.melt.contraction
    asked = beta * np.asarray(freezing_rate) + (1.0 + beta * np.asarray(solid_fraction)) * (
        np.asarray(stretching_rate)
    )
    size = np.diff(positions)
    lower = size * (2.0 * asked[:-1] + asked[1:]) / 6.0
    upper = size * (asked[:-1] + 2.0 * asked[1:]) / 6.0
    flow = np.cumsum(lower) + np.concatenate([[0.0], np.cumsum(upper)[:-1]])
    liquid = 1.0 - np.asarray(solid_fraction)
    falls = mush.melt.viscosity * size * flow * mush.mean_resistance(liquid[:-1], liquid[1:])
    return np.concatenate([np.cumsum(falls[::-1])[::-1], [0.0]])
