"""The law that adds the resistances of contact and gas layer."""

from __future__ import annotations

import numpy as np
import pytest

from castx.transfer.coefficients import SMALLEST_RELATIVE_PRESSURE
from tests.castx.transfer.law_samples import PRESSURE, SERIES, coefficient

pytestmark = pytest.mark.serial


def test_series_adds_the_resistances():
    # 1/(1/2000 + 1e-4/0.05) = 400
    heat = {"law": "series", "closed": "2 kW/m^2/K", "gas_conductivity": 0.05}
    np.testing.assert_allclose(coefficient(heat, [0.0, 1e-4]), [2000.0, 400.0])


def test_rounded_law_leaves_closure_flat_under_pressure():
    """Both sides of closure have slope zero: the law has a continuous slope through it."""
    heat = {**SERIES, "pressure": PRESSURE, "transition": "10 um"}
    knee = SMALLEST_RELATIVE_PRESSURE * 1.2e9
    small = (coefficient(heat, 0.0, 1e-4 * knee) - 800) / (coefficient(heat, 0.0, knee) - 800)
    assert abs(small[0]) < 1e-6  # a straight line would give 1e-4
    step = 1e-4 * knee
    sides = [(coefficient(heat, 0.0, knee + s) - coefficient(heat, 0.0, knee)) / s
             for s in (-step, step)]  # fmt: skip
    assert sides[0] == pytest.approx(sides[1], rel=1e-3)
    sharp = {**SERIES, "pressure": PRESSURE}
    above = np.geomspace(knee, 1e9, 20)
    np.testing.assert_allclose(coefficient(heat, 0.0, above), coefficient(sharp, 0.0, above))
