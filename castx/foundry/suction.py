"""Margin against hot tearing by the suction in the mush, after Rappaz, Drezet and Gremaud.

Melt flows towards the roots of the dendrites through a network that shrinks by freezing and opens
by strain across the growth direction. A tear begins where the suction reaches Δp_c before the
dendrites have grown together, at the liquid fraction g_c. All integrals begin at T(1 - g_c), and
the answer hangs on that cut-off, so it belongs shown as a band over g_c. It holds for columnar
growth and a skeleton that does not move along the gradient.

The idea is that of M. Rappaz, J.-M. Drezet and M. Gremaud (1999); the equations follow from the
balance of mass and Darcy's law with the permeability of `porosity`, as derived here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.mush import FreezingPath, MushIntegral
from castx.foundry.porosity import KOZENY_CARMAN, Melt, resistance

TEARING_DEPRESSION = 2e3
"""Usual Δp_c of this criterion [Pa]: interfaces that pull at films of melt, not its bulk."""
CUT_OFFS = (0.05, 0.02, 0.01)
"""Liquid fractions g_c over which the margin is shown."""


@dataclass(frozen=True, eq=False)
class MushSuction:
    """The integrals of an alloy above its cut-off, from which both suctions follow.

    H = ∫ f²/(1-f)² dT and F = (1/G) ∫ E f²/(1-f)³ dT with E(T) = ∫ f ε̇ dT, all from T(1 - g_c) up.

    Attributes:
        shrinking: H [K].
        straining: F G/ε̇ of a uniform rate of strain [K²].
    """

    shrinking: float
    straining: float

    @classmethod
    def of(cls, path: FreezingPath, cut_off: float) -> MushSuction:
        """Return the integrals of an alloy with a cut-off g_c, a liquid fraction."""
        start = path.temperature(np.array([1.0 - cut_off]))
        shrinking = float(MushIntegral(path, resistance)(start)[0])
        strained = MushIntegral(path, lambda solid: solid)
        knots = np.concatenate([start, path.knots[path.knots > start]])
        points, weights = np.polynomial.legendre.leggauss(5)
        half: FloatArray = 0.5 * (knots[1:] - knots[:-1])
        at = (knots[:-1, None] + half[:, None] * (points + 1.0)).ravel()
        solid = path.solid_fraction(at)
        gained = strained(start) - strained(at)
        values = gained * solid**2 / (1.0 - solid) ** 3
        straining = float(half @ (values.reshape(half.size, -1) @ weights))
        return cls(shrinking, straining)

    def by_shrinkage(
        self, gradient: FloatArray, speed: FloatArray, arm_spacing: FloatArray, melt: Melt
    ) -> FloatArray:
        """Return the suction by shrinkage, Δp_sh = 180 μ v_T β H/(λ2² G) [Pa].

        Args:
            gradient: G [K/m].
            speed: v_T of the isotherm [m/s].
            arm_spacing: λ2 [m]; all of one shape.
            melt: of the alloy.
        """
        drag = KOZENY_CARMAN * melt.viscosity / (np.asarray(arm_spacing) ** 2 * gradient)
        return np.asarray(drag * speed * melt.contraction * self.shrinking)

    def critical_rate(
        self, gradient: FloatArray, speed: FloatArray, arm_spacing: FloatArray, melt: Melt
    ) -> FloatArray:
        """Return the rate of strain at which the suction reaches Δp_c [1/s]; arguments as above.

        From F(ε̇_c) = λ2² G Δp_c/(180 (1 + β) μ) - v_T β H/(1 + β); zero where shrinkage alone
        cavitates.
        """
        beta = melt.contraction
        pull = melt.cavitation / (KOZENY_CARMAN * (1.0 + beta) * melt.viscosity)
        room = pull * np.asarray(arm_spacing) ** 2 * gradient - speed * (
            beta * self.shrinking / (1.0 + beta)
        )
        return np.asarray(np.maximum(room, 0.0) * gradient / self.straining)


def rate_across(strain_gained: FloatArray, time_between: FloatArray) -> FloatArray:
    """Return ε̇_⟂, strain across the gradient over the time in which it was gained [1/s].

    Args:
        strain_gained: largest positive principal strain across ∇T gained between f = 0.9 and
            1 - g_c.
        time_between: these two passings [s].
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.maximum(strain_gained, 0.0) / time_between)


def tearing_margin(rate: FloatArray, critical_rate: FloatArray) -> FloatArray:
    """Return ε̇_⟂/ε̇_c, above 1 where a tear is to be expected.

    Infinite where ε̇_c = 0: shrinkage alone cavitates, strained or not.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        margin = np.asarray(rate) / critical_rate
    alone = np.isfinite(rate) & (np.asarray(critical_rate) == 0.0)
    return np.asarray(np.where(alone, np.inf, margin))
