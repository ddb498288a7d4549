"""Heat condition `radiation`: the fourth powers of absolute temperatures."""

from __future__ import annotations

import numpy as np
import pytest

from tests.heat_conditions import flux_law

pytestmark = pytest.mark.serial


def test_means_over_a_step():
    """From 2 to 6 s the emissivity is that at 4 s, 0.36."""
    law = flux_law("radiation", emissivity=[[0.0, 0.2], [10.0, 0.6]], ambient=500.0)
    T = np.array([100.0, 900.0])
    flux, slope = law(2.0, 6.0, T)
    factor = 0.36 * 5.670374419e-8
    assert flux == pytest.approx(factor * (773.15**4 - (T + 273.15) ** 4))
    assert slope == pytest.approx(-4.0 * factor * (T + 273.15) ** 3)
