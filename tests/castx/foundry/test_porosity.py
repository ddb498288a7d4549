"""Niyama values and pore fractions against values computed independently."""

import numpy as np
import pytest

from castx.foundry.arm_spacing import ArmSpacing
from castx.foundry.mush import FreezingPath
from castx.foundry.porosity import (
    CriticalLiquid,
    Melt,
    dimensionless_niyama,
    melt_contraction,
    niyama,
    pore_fraction,
)
from castx.materials.solid_fraction import LinearLaw, ScheilLaw, TabulatedLaw

pytestmark = pytest.mark.serial

LINEAR = CriticalLiquid(FreezingPath(LinearLaw(), 560.0, 615.0))
SCHEIL = CriticalLiquid(FreezingPath(ScheilLaw(0.14, 660.3), 548.2, 646.0))
EUTECTIC = 0.0912329


def test_both_shrinkages():
    assert melt_contraction(np.array(0.0588235294117647)) == pytest.approx(0.0625, rel=1e-14)
    beta = melt_contraction(np.array([0.05, -0.02]))
    np.testing.assert_allclose(beta / (1.0 + beta), [0.05, -0.02], rtol=1e-14)


def test_niyama_of_a_steel_in_its_customary_unit():
    """1 K^½ min^½/cm is 774.597 K^½ s^½/m: here 1 K/cm at 1 K/min."""
    assert niyama(np.array(100.0), np.array(1.0 / 60.0)) == pytest.approx(774.597, rel=1e-6)


@pytest.mark.parametrize(
    ("liquid", "value"),
    [
        (0.9, 0.264980), (0.5, 4.524049), (0.2, 16.87016), (0.1, 30.87182), (0.05, 50.12521),
        (0.02, 87.10954),
    ],
)  # fmt: skip
def test_the_critical_liquid_of_a_linear_law(liquid, value):
    assert np.sqrt(LINEAR.suction(np.array([liquid])))[0] == pytest.approx(value, rel=2e-6)
    own = np.sqrt(180.0 * (1.0 / liquid + 2.0 * np.log(liquid) - liquid))
    assert LINEAR(np.array([own]))[0] == pytest.approx(liquid, rel=1e-9)


@pytest.mark.parametrize("liquid", [1e-7, 1e-5, 3e-3, 0.37, 0.98])
def test_the_critical_liquid_is_found_far_down(liquid):
    own = 180.0 * (1.0 / liquid + 2.0 * np.log(liquid) - liquid)
    assert LINEAR.suction(np.array([liquid]))[0] == pytest.approx(own, rel=1e-6)
    assert LINEAR(np.sqrt(np.array([own])))[0] == pytest.approx(liquid, rel=1e-6)


def test_the_suction_of_an_alloy_by_scheil():
    found = SCHEIL.suction(np.array([0.5, 0.3, 0.2, EUTECTIC]))
    np.testing.assert_allclose(found, [6.983703, 83.39936, 399.1399, 5558.827], rtol=1e-5)


def test_a_eutectic_that_is_fed_leaves_no_pores():
    whole = np.sqrt(5558.827)
    found = SCHEIL(whole * np.array([0.999, 1.001, np.inf, np.nan]))
    assert found[0] == pytest.approx(EUTECTIC, rel=2e-3) and found[0] > EUTECTIC
    np.testing.assert_array_equal(found[1:], [0.0, 0.0, np.nan])
    assert np.isnan(pore_fraction(found, 0.05)[3])


def test_a_plateau_on_the_way_adds_nothing():
    """Two straight halves about a plateau: I of the colder one goes on from that of the hotter."""
    law = TabulatedLaw(((500.0, 1.0), (550.0, 0.8), (550.0, 0.4), (600.0, 0.0)))
    critical = CriticalLiquid(FreezingPath(law, 500.0, 600.0))

    def straight(low, high, slope):
        def inner(g):
            return -1.0 / g - 2.0 * np.log(g) + g

        return 180.0 * slope * (inner(high) - inner(low))

    hot = straight(0.6, 1.0, 50.0 / 0.4 / 100.0)
    cold = hot + straight(0.05, 0.2, 50.0 / 0.2 / 100.0)
    found = critical(np.sqrt(np.array([0.999999 * hot, 1.000001 * hot, cold])))
    np.testing.assert_allclose(found, [0.6, 0.2, 0.05], rtol=1e-4)
    np.testing.assert_allclose(critical.suction(np.array([0.3, 0.05])), [hot, cold], rtol=1e-10)


def test_an_alloy_on_a_chilled_wall():
    """V3 at 5, 10 and 20 mm: both fronts go with √t, G = 2740.71 √Ṫ, t = 1.4e4 x² or so."""
    melt = Melt(1.2e-3, 0.0625, 1.01e5)
    spacing = ArmSpacing(4e-5)
    exact = np.array([6.219406e-6, 9.872691e-6, 15.67192e-6])
    rate = (4e-5 / exact) ** 3
    gradient = 2740.71 * np.sqrt(rate)
    own = spacing(rate)
    np.testing.assert_allclose(own, exact, rtol=1e-12)
    found = dimensionless_niyama(gradient, rate, own, melt, 55.0)
    np.testing.assert_allclose(found, [84.34513, 133.8896, 212.5364], rtol=3e-6)
    x = np.array([5e-3, 10e-3, 20e-3])
    np.testing.assert_allclose(found, 2884.563 * x ** (2.0 / 3.0), rtol=3e-6)
    values = np.array([84.34513, 133.8896, 212.5364])
    pores = 100.0 * pore_fraction(LINEAR(values), 0.0625 / 1.0625)
    np.testing.assert_allclose(pores, [0.124481, 0.0539751, 0.0224436], rtol=3e-6)


def test_what_expands_needs_no_feeding():
    melt = Melt(1.2e-3, -0.02)
    value = dimensionless_niyama(np.array([1e3]), np.array([1.0]), np.array([4e-5]), melt, 55.0)
    assert np.isposinf(value[0]) and pore_fraction(LINEAR(value), -0.0204)[0] == 0.0


def test_melt_that_bears_no_depression_shrinks_unfed():
    melt = Melt(1.2e-3, 0.0625, 0.0)
    value = dimensionless_niyama(np.array([1e3]), np.array([1.0]), np.array([4e-5]), melt, 55.0)
    assert pore_fraction(LINEAR(value), 0.05)[0] == pytest.approx(0.05, rel=1e-12)


def test_metal_that_swells_as_it_freezes_has_no_pores():
    np.testing.assert_array_equal(pore_fraction(np.array([0.0, 0.1, 0.4]), -0.02), 0.0)
    np.testing.assert_allclose(pore_fraction(np.array([0.1, 0.4]), 0.05), [5e-3, 2e-2], rtol=1e-14)
