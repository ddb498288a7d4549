"""Arm spacing and yield strength."""

import numpy as np
import pytest

from castx.foundry.arm_spacing import ArmSpacing, yield_strength

pytestmark = pytest.mark.serial


def test_the_spacing_falls_with_the_third_root_of_the_cooling_rate():
    rates = np.array([1e-3, 1.0, 8.0, 1000.0])
    found = ArmSpacing(4e-5)(rates)
    np.testing.assert_allclose(found, [4e-4, 4e-5, 2e-5, 4e-6], rtol=1e-14)


def test_another_exponent_and_none():
    assert ArmSpacing(5e-5, 0.5)(np.array([4.0]))[0] == pytest.approx(2.5e-5, rel=1e-14)
    np.testing.assert_array_equal(ArmSpacing(3e-5, 0.0)(np.array([1.0, 77.0])), [3e-5, 3e-5])


def test_the_yield_strength_of_a_fine_structure_is_high():
    found = yield_strength(np.array([25e-6, 100e-6]), 80e6, 2e5)
    np.testing.assert_allclose(found, [120e6, 100e6], rtol=1e-14)
