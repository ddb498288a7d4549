"""Chvorinov's constant and the modulus."""

import numpy as np
import pytest

from castx.foundry.modulus import PouredMetal, SandMould, mould_constant, thermal_modulus

pytestmark = pytest.mark.serial

METAL = PouredMetal(9.8e8, 2.7e6, 640.0, 560.0, 615.0)
SAND = SandMould(0.7, 1.6e6, 20.0)


def test_the_constant_of_a_sand_mould():
    constant = mould_constant(METAL, SAND)
    assert constant == pytest.approx(2.389176e6, rel=1e-6)
    assert constant * 0.01**2 == pytest.approx(238.918, rel=1e-5)  # a plate of 20 mm
    assert thermal_modulus(np.array([238.918]), constant)[0] == pytest.approx(0.01, rel=1e-5)


def test_the_constant_is_the_heat_of_the_metal_over_what_the_half_space_draws():
    """By summing the flux (T_m - T_0) √(kρc/(πt)) until it has drawn the heat of the modulus."""
    metal = PouredMetal(1.9e9, 4.5e6, 1560.0, 1440.0, 1500.0)
    mould = SandMould(1.1, 1.8e6, 35.0)
    modulus, time = 0.025, mould_constant(metal, mould) * 0.025**2
    roots = np.linspace(0.0, np.sqrt(time), 1001)  # ∫ dt/√t = ∫ 2 d√t
    drawn = (1470.0 - 35.0) * np.sqrt(1.1 * 1.8e6 / np.pi) * np.trapezoid(np.full(1001, 2.0), roots)
    assert drawn == pytest.approx((1.9e9 + 4.5e6 * 60.0) * modulus, rel=1e-12)
