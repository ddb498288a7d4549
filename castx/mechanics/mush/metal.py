"""What a body has to know of its metal and its feeders to let melt flow through its mush."""

from __future__ import annotations

from dataclasses import dataclass

from castx.foundry.mush_column import MushResistance
from castx.foundry.porosity import Melt

LEAST_SOLID = 0.05
"""Least solid fraction in the permeability: pure liquid rests within a pascal all the same."""


@dataclass(frozen=True)
class MushMetal:
    """A metal whose melt flows through its mush, and the surfaces that feed it.

    Attributes:
        contraction: β, by which it shrinks as it freezes, relative to the liquid.
        viscosity: μ of the melt [Pa s].
        cavitation: Δp_c, the depression at which pores open [Pa].
        coalescence: solid fraction 1 − g_c beyond which the melt no longer is connected.
        spacing: C_λ of the arm spacing λ2 = C_λ Ṫ^(−n) [m (K/s)^n].
        exponent: n; 0: the spacing is C_λ.
        liquidus: [°C].
        feeders: names of the surfaces that feed; None: all free ones.
        latent: latent heat over the heat capacity of the melt [K].
    """

    contraction: float
    viscosity: float
    cavitation: float
    coalescence: float
    spacing: float
    exponent: float
    liquidus: float
    feeders: tuple[str, ...] | None = None
    latent: float = 0.0

    def resistance(self) -> MushResistance:
        """Return the resistance of a mush whose arms are one metre apart."""
        melt = Melt(self.viscosity, self.contraction, self.cavitation)
        return MushResistance(melt, 1.0, 1.0 - self.coalescence, LEAST_SOLID)
