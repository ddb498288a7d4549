"""Heat radiation of grey surfaces (Stefan and Boltzmann; Chiumenti, section 9.3)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from castx.arrays import FloatArray
from castx.input.units import ABSOLUTE_ZERO

STEFAN_BOLTZMANN = 5.670374419e-8
"""W/m²/K⁴, CODATA 2018."""


def emission(temperature: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return σ T⁴ [W/m²] of a black surface and its derivative [W/m²/K].

    Below absolute zero, where only an unfinished iteration comes, it goes on as an odd function, so
    that hotter always means more.

    Args:
        temperature: [°C].
    """
    absolute = temperature - ABSOLUTE_ZERO
    cube = np.abs(absolute) ** 3
    return STEFAN_BOLTZMANN * absolute * cube, 4.0 * STEFAN_BOLTZMANN * cube


def facing_factor(emissivities: Sequence[float]) -> float:
    """Return 1/(1/ε₁ + 1/ε₂ − 1) of two facing surfaces so close that they see only each other."""
    first, second = emissivities
    return 1.0 / (1.0 / first + 1.0 / second - 1.0)
