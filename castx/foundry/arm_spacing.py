"""Secondary dendrite arm spacing from the cooling rate, and yield strength from the spacing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.materials.foundry_data import RIPENING


@dataclass(frozen=True)
class ArmSpacing:
    """Spacing of the secondary arms, λ2 = C_λ Ṫ^(-n); constant if n = 0.

    Source: W. Kurz and D. J. Fisher, Fundamentals of Solidification, 1998, ch. 4 (arms coarsen with
    the third root of the time, which gives n = 1/3).

    Attributes:
        coefficient: C_λ, the spacing at 1 K/s [m (K/s)^n].
        exponent: n.
    """

    coefficient: float
    exponent: float = RIPENING

    def __call__(self, cooling_rate: FloatArray) -> FloatArray:
        """Return λ2 [m] at cooling rates Ṫ > 0 [K/s], in their shape."""
        rate = np.asarray(cooling_rate, dtype=np.float64)
        return np.asarray(self.coefficient * rate ** (-self.exponent))


def yield_strength(arm_spacing: FloatArray, base: float, slope: float) -> FloatArray:
    """Return the yield strength of a regression, σ = σ_0 + k λ2^(-½) [Pa].

    It is valid only for the heat treatment of the samples it was fitted to.

    Args:
        arm_spacing: λ2 [m].
        base: σ_0 [Pa].
        slope: k [Pa m^½].
    """
    return np.asarray(base + slope / np.sqrt(arm_spacing))
