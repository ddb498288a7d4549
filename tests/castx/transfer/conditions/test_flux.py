"""Heat condition `flux`: its mean over a step, whatever the temperature."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError
from tests.heat_conditions import flux_law

pytestmark = pytest.mark.serial


def test_the_mean_over_a_step():
    """From 2 to 6 s the mean is that at 4 s."""
    law = flux_law("flux", value=[[0.0, "0.1 kW/m^2"], [10.0, 300.0]])
    flux, slope = law(2.0, 6.0, np.array([100.0, 900.0]))
    assert flux == pytest.approx([180.0, 180.0])
    assert not slope.any()


def test_what_it_may_vary_with():
    with pytest.raises(CaseError, match=r"value.formula: 'p' means nothing in a formula"):
        flux_law("flux", value={"formula": "p*x"})
    with pytest.raises(CaseError, match=r"value.along: unknown; allowed: x, y, z, r, t"):
        flux_law("flux", value={"along": "time", "table": [[0, 1]]})
