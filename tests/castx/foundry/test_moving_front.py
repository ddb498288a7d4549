"""Pores behind a moving front against exact values, and against numbers found another way."""

import numpy as np
import pytest
from scipy.integrate import quad

from castx.foundry.moving_front import PoresBehindFront
from castx.foundry.mush import FreezingPath
from castx.foundry.porosity import CriticalLiquid, Melt, dimensionless_niyama, pore_fraction
from castx.materials.solid_fraction import LinearLaw, ScheilLaw

pytestmark = pytest.mark.serial

LINEAR = FreezingPath(LinearLaw(), 550.0, 600.0)
PLACE = np.array([1e4]), np.array([1e-3]), np.array([50e-6])
SHARE = 0.06 / 1.06


@pytest.mark.parametrize(
    ("depression", "liquid", "pores"),
    [(100.0, 0.0578846, 3.276485e-3), (300.0, 0.0258256, 1.461824e-3)],
)
def test_pores_of_a_linear_alloy(depression, liquid, pores):
    front = PoresBehindFront(LINEAR, Melt(1e-3, 0.06, depression))
    assert front.critical_liquid(*PLACE)[0] == pytest.approx(liquid, rel=2e-6)
    assert front.pores(*PLACE)[0] == pytest.approx(pores, rel=1e-6)


def test_the_suction_is_that_of_the_closed_form():
    x = np.array([0.5, 0.1, 0.02, 1e-3])
    closed = 1 / (2 * x) + 2 + (2 + x) * np.log(x) - 2.5 * x
    drive = 1e-3 / (2.5e-9 * 1e4)
    found = PoresBehindFront(LINEAR, Melt(1e-3, 0.06)).suction(x, np.array(drive))
    np.testing.assert_allclose(found, 180 * 1e-3 * 0.06 * drive * 50.0 * closed, rtol=1e-9)


def test_the_closure_that_feeds_all_until_then_has_about_twice_the_pores():
    melt = Melt(1e-3, 0.06, 100.0)
    gradient, speed, spacing = PLACE
    number = dimensionless_niyama(gradient, gradient * speed, spacing, melt, 50.0)
    other = pore_fraction(CriticalLiquid(LINEAR)(number), SHARE)[0]
    assert other == pytest.approx(6.172242e-3, rel=1e-6)


def test_an_alloy_with_a_eutectic():
    path = FreezingPath(ScheilLaw(0.14, 660.3), 548.2, 646.0)
    melt = Melt(1.2e-3, 0.0625, 2e4)
    front = PoresBehindFront(path, melt)
    drive = np.array(1.0 / (400e-12 * 2e3)) * 2e-3
    x = front.critical_liquid(np.array([2e3]), np.array([2e-3]), np.array([20e-6]))

    def weight(temperature):
        f = path.solid_fraction(np.array([temperature]))[0]
        return (1.0 - f - x[0]) * f**2 / (1.0 - f) ** 3

    start = path.temperature(1.0 - x)[0]
    suction = 180 * 1.2e-3 * 0.0625 * drive * quad(weight, start, 646.0, limit=200)[0]
    assert 0.0912 < x[0] < 0.9 and suction == pytest.approx(2e4, rel=1e-6)
    fed = front.critical_liquid(np.array([2e6]), np.array([2e-4]), np.array([20e-6]))
    assert fed[0] == 0.0
