"""Strain range and life of a die surface."""

import numpy as np
import pytest

from castx.foundry.die_life import Fatigue, restrained_strain, strain_range

pytestmark = pytest.mark.serial

STEEL = Fatigue(2000e6, -0.08, 0.4, -0.65)


def test_a_restrained_surface():
    strain = restrained_strain(12.5e-6, 300.0, 0.29)
    assert strain == pytest.approx(5.281690e-3, rel=1e-6)
    assert 205e9 * strain == pytest.approx(1082.746e6, rel=1e-6)


def test_the_range_has_an_elastic_and_a_plastic_part():
    found = strain_range(np.array([410e6, 0.0]), np.array([1e-3, 2e-3]), 205e9)
    np.testing.assert_allclose(found, [3e-3, 2e-3], rtol=1e-14)


def test_the_life_of_a_hot_work_steel():
    found = STEEL.cycles(np.array([0.008, 0.012, 0.0]), 205e9)
    np.testing.assert_allclose(found[:2], [63942.07, 3716.959], rtol=1e-6)
    assert np.isposinf(found[2])


@pytest.mark.parametrize("cycles", [0.6, 1e2, 1e5, 1e9])
@pytest.mark.parametrize("coefficients", [(900e6, -0.12, 0.9, -0.5), (3e9, -0.05, 0.05, -0.7)])
def test_the_life_leads_back_to_the_strain(cycles, coefficients):
    strength, b, ductility, c = coefficients
    reversals = 2.0 * cycles
    strain = 2.0 * (strength / 180e9 * reversals**b + ductility * reversals**c)
    found = Fatigue(*coefficients).cycles(np.array([strain]), 180e9)
    assert found[0] == pytest.approx(cycles, rel=1e-9)
