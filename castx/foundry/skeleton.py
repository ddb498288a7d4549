"""A mush that is loaded: consolidation while melt leaves it, and without drainage.

The stress of the skeleton is a deviator of shear modulus G, and melt bears the mean stress. Held at
its sides, the drained modulus is 4G/3. Source: K. Terzaghi, Theoretical Soil Mechanics (1943).
"""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray

TERMS = 2000


def consolidation_coefficient(permeability: float, viscosity: float, shear_modulus: float) -> float:
    """Return c_v = (K/μ) 4G/3 [m²/s].

    Args:
        permeability: K [m²].
        viscosity: μ of the melt [Pa s].
        shear_modulus: G of the skeleton [Pa].
    """
    return permeability / viscosity * 4.0 * shear_modulus / 3.0


def consolidation(
    time: FloatArray, length: float, load: float, shear_modulus: float, coefficient: float
) -> tuple[FloatArray, FloatArray]:
    """Return settlement [m] and pressure of the melt at the shut base [Pa] of a loaded column.

    Terzaghi: u = (q L/M)(1 - Σ 2/m² exp(-m² c_v t/L²)), p_l = q Σ (2/m) sin m exp(-m² c_v t/L²)
    with M = 4G/3 and m = π(2k + 1)/2.

    Args:
        time: after the load was set on [s], positive, (n,).
        length: L from the base to the drained end, which bears the load [m].
        load: q [Pa].
        shear_modulus: G [Pa].
        coefficient: c_v [m²/s].
    """
    m = np.pi * (np.arange(TERMS) + 0.5)
    fading = np.exp(-np.outer(coefficient * np.atleast_1d(time) / length**2, m**2))
    whole = load * length / (4.0 * shear_modulus / 3.0)
    settlement = whole * (1.0 - fading @ (2.0 / m**2))
    return settlement, load * (fading @ (2.0 * np.sin(m) / m))


def undrained(
    before: float, after: float, contraction: float, shear_modulus: float
) -> tuple[float, float]:
    """Return strain along a free column held at its sides, and pressure of its melt [Pa].

    It freezes from one solid fraction to another while no melt moves, so that (1 + β f)(1 + u′)
    stays, and nothing loads it: p_l = 4G/3 u′, suction where it shrinks.

    Args:
        before: f at first.
        after: f at last.
        contraction: β.
        shear_modulus: G [Pa].
    """
    strain = (1.0 + contraction * before) / (1.0 + contraction * after) - 1.0
    return strain, 4.0 * shear_modulus / 3.0 * strain
