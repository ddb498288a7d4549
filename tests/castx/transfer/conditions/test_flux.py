"""Heat condition `flux`: its mean over a step, whatever the temperature."""

from __future__ import annotations

import numpy as np
import pytest

from tests.heat_conditions import flux_law

pytestmark = pytest.mark.serial


def test_the_mean_over_a_step():
    """From 2 to 6 s the mean is that at 4 s."""
    law = flux_law("flux", value=[[0.0, "0.1 kW/m^2"], [10.0, 300.0]])
    flux, slope = law(2.0, 6.0, np.array([100.0, 900.0]))
    assert flux == pytest.approx([180.0, 180.0])
    assert not slope.any()
