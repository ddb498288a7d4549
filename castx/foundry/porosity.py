"""Shrinkage porosity from the thermal history: Niyama criterion, its dimensionless form, pores.

The melt that feeds the last liquid of a mush flows through the network of dendrites, whose
permeability is that of Kozeny and Carman, K = λ2² g³/(180 (1-g)²), g the liquid fraction. In a
front that travels steadily the suction there is
    Δp = μ β v_T ΔT_f/(λ2² G) I(g),   I(x) = ∫_x^1 180 (1-g)²/g² (dθ/dg) dg,
with θ = (T - T_S)/ΔT_f by the alloy's own law of freezing and β = (ρ_s - ρ_l)/ρ_l. Where it reaches
Δp_c pores open, and what is left liquid shrinks unfed.

Niyama criterion: E. Niyama, T. Uchida, M. Morikawa and S. Saito, AFS Int. Cast Metals J. 7 (1982)
52-63. Dimensionless form: K. D. Carlson and C. Beckermann, Metall. Mater. Trans. A 40 (2009) 163.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.mush import FreezingPath, MushIntegral
from castx.materials.material import ATMOSPHERE

KOZENY_CARMAN = 180.0
"""36 · 5: spheres of one size, Kozeny's constant 5."""


def melt_contraction(shrinkage: FloatArray) -> FloatArray:
    """Return β = s/(1 - s), the shrinkage relative to the liquid.

    Args:
        shrinkage: s = (ρ_s - ρ_l)/ρ_s, relative to the solid, below 1.
    """
    return np.asarray(shrinkage / (1.0 - np.asarray(shrinkage)))


def niyama(gradient: FloatArray, cooling_rate: FloatArray) -> FloatArray:
    """Return the Niyama criterion, Ny = G/√Ṫ [K^½ s^½/m].

    Args:
        gradient: G [K/m].
        cooling_rate: Ṫ, positive [K/s], of the same shape.
    """
    return np.asarray(gradient / np.sqrt(cooling_rate))


@dataclass(frozen=True, eq=False)
class Melt:
    """Properties of a melt that decide how hard a mush is to feed.

    Attributes:
        viscosity: μ of the melt [Pa s].
        contraction: β, see `melt_contraction`.
        cavitation: depression Δp_c at which pores open [Pa].
    """

    viscosity: float
    contraction: float
    cavitation: float = ATMOSPHERE


def dimensionless_niyama(
    gradient: FloatArray,
    cooling_rate: FloatArray,
    arm_spacing: FloatArray,
    melt: Melt,
    freezing_range: float,
) -> FloatArray:
    """Return Ny* = λ2 G √(Δp_c/(μ β ΔT_f Ṫ)); infinite where nothing shrinks.

    Args:
        gradient: G [K/m].
        cooling_rate: Ṫ [K/s].
        arm_spacing: λ2 [m]; all three of one shape.
        melt: of the alloy.
        freezing_range: ΔT_f [K].
    """
    drag = melt.viscosity * max(melt.contraction, 0.0) * freezing_range * np.asarray(cooling_rate)
    with np.errstate(divide="ignore"):
        return np.asarray(arm_spacing * gradient * np.sqrt(melt.cavitation / drag))


class CriticalLiquid:
    """The liquid fraction at which pores open, g_cr from I(g_cr) = Ny*².

    Args:
        path: of the alloy.
    """

    def __init__(self, path: FreezingPath) -> None:
        self._path = path

    @cached_property
    def _integral(self) -> MushIntegral:
        return MushIntegral(self._path, resistance)

    def suction(self, liquid: FloatArray) -> FloatArray:
        """Return I(x) = ∫_x^1 180 (1-g)²/g² (dθ/dg) dg of liquid fractions x, (n,)."""
        at = self._path.temperature(1.0 - np.atleast_1d(liquid))
        return np.asarray(KOZENY_CARMAN * self._integral(at) / self._path.freezing_range)

    def __call__(self, dimensionless: FloatArray) -> FloatArray:
        """Return g_cr of values of Ny* (n,); zero where the first eutectic liquid is fed already.

        What freezes at the solidus adds nothing to I. Not a number where Ny* is none.
        """
        values = np.asarray(dimensionless, dtype=np.float64)
        found = np.full(values.shape, np.nan)
        known = np.isfinite(values)
        wanted = values[known] ** 2 * self._path.freezing_range / KOZENY_CARMAN
        at = self._integral.inverse(wanted)
        fed = wanted > self._integral.whole
        found[known] = np.where(fed, 0.0, 1.0 - self._path.solid_fraction(at))
        found[np.isposinf(values)] = 0.0
        return found


def resistance(solid: FloatArray) -> FloatArray:
    """Return f²/(1-f)², the resistance of the network to the flow that shrinkage asks for."""
    return np.asarray(solid**2 / (1.0 - solid) ** 2)


def pore_fraction(critical_liquid: FloatArray, shrinkage: float) -> FloatArray:
    """Return the share of pores, g_p = s g_cr, with s = (ρ_s - ρ_l)/ρ_s; none where s < 0."""
    return np.asarray(max(shrinkage, 0.0) * critical_liquid)
