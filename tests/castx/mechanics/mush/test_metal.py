"""Resistance of a mush with the floors of its cells."""

from __future__ import annotations

import numpy as np
import pytest

from castx.mechanics.mush.metal import MushMetal

pytestmark = pytest.mark.serial


def test_permeability_with_its_floors():
    """λ2²/180 g³/f² between g_c = 0.02 and f = 0.05, for arms of a metre."""
    metal = MushMetal(0.06, 1e-3, 1e5, 0.98, 50e-6, 0.0, 615.0)
    found = metal.resistance().permeability(np.array([0.0, 0.02, 0.3, 0.97, 1.0]))
    expected = [8e-6 / 0.9604, 8e-6 / 0.9604, 0.027 / 0.49, 0.97**3 / 0.0025, 1.0 / 0.0025]
    np.testing.assert_allclose(180.0 * found, expected, rtol=1e-12)
