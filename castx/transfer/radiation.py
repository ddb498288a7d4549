"""Heat radiation of grey surfaces (Stefan and Boltzmann; Chiumenti, section 9.3)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from castx.arrays import FloatArray
from castx.input.units import ABSOLUTE_ZERO

STEFAN_BOLTZMANN = 5.670374419e-8
"""W/m²/K⁴, CODATA 2018."""


def emission(temperature: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return σ T⁴ [W/m²] of a black surface and its derivative 4 σ T³ [W/m²/K], T absolute.

    Below absolute zero, reached only within an iteration, it continues as an odd function, so that
    it always increases with temperature.
    Source: J. Stefan (1879), L. Boltzmann (1884).

    Args:
        temperature: [°C].
    """
    absolute = temperature - ABSOLUTE_ZERO
    cube = np.abs(absolute) ** 3
    return STEFAN_BOLTZMANN * absolute * cube, 4.0 * STEFAN_BOLTZMANN * cube


def radiation_coefficient(first: float, second: float) -> float:
    """Return the coefficient σ (T₁² + T₂²) (T₁ + T₂) between black surfaces [W/m²/K], T absolute.

    It is the difference of `emission` over that of the temperatures, where these are equal too.

    Args:
        first: temperature of one surface [°C].
        second: of the other.
    """
    a, b = first - ABSOLUTE_ZERO, second - ABSOLUTE_ZERO
    return STEFAN_BOLTZMANN * (a * a + b * b) * (a + b)


def facing_factor(emissivities: Sequence[float]) -> float:
    """Return the factor 1/(1/ε₁ + 1/ε₂ − 1) of radiation between two close parallel surfaces.

    Source: M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.3.

    Args:
        emissivities: ε of both surfaces.
    """
    first, second = emissivities
    return 1.0 / (1.0 / first + 1.0 / second - 1.0)
