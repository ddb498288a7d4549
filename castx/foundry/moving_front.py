"""Pores that a front leaves behind it, by the flow that ends where they open.

In the closure of `castx.foundry.porosity` all shrinkage is fed until pores open. Here what lies
behind the first pores is not fed, so that the flow at a liquid fraction g is β v_T (g - g_cr):
    Δp(x) = 180 μ β v_T/(λ2² G) ∫_x^1 (g - x) f²/g³ dT = Δp_c at x = g_cr.
For f linear in T the integral is ΔT_f (1/(2x) + 2 + (2 + x) ln x - 5x/2). It gives about half the
pores of the other closure.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.mush import FreezingPath, MushIntegral
from castx.foundry.porosity import KOZENY_CARMAN, Melt, pore_fraction, resistance

HALVINGS = 100


class PoresBehindFront:
    """Liquid fraction at which pores open behind a front that travels evenly, and their share.

    Args:
        path: way of freezing of the alloy.
        melt: of the alloy; its contraction is positive.
    """

    def __init__(self, path: FreezingPath, melt: Melt) -> None:
        self._path, self._melt = path, melt

    @cached_property
    def _integrals(self) -> tuple[MushIntegral, MushIntegral]:
        """∫ f²/g² dT and ∫ f²/g³ dT from a temperature up."""
        cubed = MushIntegral(self._path, lambda solid: solid**2 / (1.0 - solid) ** 3)
        return MushIntegral(self._path, resistance), cubed

    def suction(self, liquid: FloatArray, drive: FloatArray) -> FloatArray:
        """Return Δp of liquid fractions below which nothing is fed [Pa], (n,).

        Args:
            liquid: x, (n,).
            drive: v_T/(λ2² G) of the places [1/(K m s)], (n,) or one number.
        """
        x = np.atleast_1d(np.asarray(liquid, dtype=np.float64))
        at = self._path.temperature(1.0 - x)
        square, cube = (integral(at) for integral in self._integrals)
        drag = KOZENY_CARMAN * self._melt.viscosity * self._melt.contraction
        return np.asarray(drag * np.asarray(drive) * (square - x * cube))

    def critical_liquid(
        self, gradient: FloatArray, speed: FloatArray, arm_spacing: FloatArray
    ) -> FloatArray:
        """Return g_cr, zero where the last liquid above the solidus is fed, (n,).

        Args:
            gradient: G [K/m], (n,).
            speed: v_T of the isotherm [m/s].
            arm_spacing: λ2 [m].
        """
        drive = np.atleast_1d(speed / (np.asarray(arm_spacing) ** 2 * gradient))
        low, high = np.zeros(drive.shape), np.ones(drive.shape)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            opened = self.suction(middle, drive) > self._melt.cavitation
            low, high = np.where(opened, middle, low), np.where(opened, high, middle)
        last = 1.0 - self._path.solid_fraction(np.nextafter([self._path.solidus], np.inf))
        return np.where(high <= np.maximum(last, 1e-12), 0.0, high)

    def pores(self, gradient: FloatArray, speed: FloatArray, arm_spacing: FloatArray) -> FloatArray:
        """Return the share of pores s g_cr, s = β/(1 + β), (n,); arguments as above."""
        beta = self._melt.contraction
        found = self.critical_liquid(gradient, speed, arm_spacing)
        return pore_fraction(found, beta / (1.0 + beta))
