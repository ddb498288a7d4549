"""Suction in the mush and the critical rate of strain against values computed independently."""

import numpy as np
import pytest
from scipy.integrate import dblquad, quad, simpson

from castx.foundry.mush import FreezingPath
from castx.foundry.porosity import CriticalLiquid, Melt, dimensionless_niyama
from castx.foundry.suction import CUT_OFFS, MushSuction, rate_across, tearing_margin
from castx.materials.solid_fraction import LinearLaw, ScheilLaw

pytestmark = pytest.mark.serial

LINEAR = FreezingPath(LinearLaw(), 550.0, 600.0)
MELT = Melt(1e-3, 0.06, 2000.0)
PLACE = (np.array([1e4]), np.array([1e-3]), np.array([50e-6]))


def test_the_integrals_of_a_linear_law():
    found = MushSuction.of(LINEAR, 0.02)
    assert found.shrinking == pytest.approx(50.0 * 42.155954, rel=1e-7)
    assert found.straining / 2500.0 == pytest.approx(18.052884, rel=1e-7)
    assert MushSuction.of(LINEAR, 0.01).straining / 2500.0 == pytest.approx(41.396353, rel=1e-7)


@pytest.mark.parametrize(
    ("cut_off", "suction", "rate"), [(0.02, 910.5686, 0.03162823), (0.01, 1960.841, 4.957869e-4)]
)
def test_the_worked_example(cut_off, suction, rate):
    found = MushSuction.of(LINEAR, cut_off)
    assert found.by_shrinkage(*PLACE, MELT)[0] == pytest.approx(suction, rel=1e-6)
    assert found.critical_rate(*PLACE, MELT)[0] == pytest.approx(rate, rel=1e-5)


def test_without_shrinkage_more_strain_is_borne():
    still = (PLACE[0], np.zeros(1), PLACE[2])
    found = MushSuction.of(LINEAR, 0.02).critical_rate(*still, MELT)
    assert found[0] == pytest.approx(0.05806374, rel=1e-5)


def test_strain_that_counts_from_the_solidus_would_be_borne_less():
    """The lower limit of E(T) decides: with T_S in place of T(1 - g_c) it is 0.01395016/s."""
    solid = np.linspace(1e-12, 0.98, 20001)  # f linear in T: E = ε̇ ΔT_f (1 - f²)/2 from T_S
    weight = 0.5 * (1.0 - solid**2) * solid**2 / (1.0 - solid) ** 3
    straining = 2500.0 * simpson(weight, x=solid)
    found = MushSuction(MushSuction.of(LINEAR, 0.02).shrinking, straining)
    assert found.critical_rate(*PLACE, MELT)[0] == pytest.approx(0.01395016, rel=1e-5)


def test_shrinkage_alone_cavitates():
    fast = (PLACE[0], np.array([1e-2]), PLACE[2])
    assert MushSuction.of(LINEAR, 0.02).critical_rate(*fast, MELT)[0] == 0.0


def test_its_suction_is_that_of_the_niyama_criterion():
    rate = PLACE[0] * PLACE[1]
    for path in (LINEAR, FreezingPath(ScheilLaw(0.2, 660.3), 500.0, 640.0)):
        value = dimensionless_niyama(PLACE[0], rate, PLACE[2], MELT, path.freezing_range)
        suction = MushSuction.of(path, 0.03).by_shrinkage(*PLACE, MELT) / MELT.cavitation
        ratio = CriticalLiquid(path).suction(np.array([0.03])) / value**2
        np.testing.assert_allclose(suction, ratio, rtol=1e-10)
    value = dimensionless_niyama(PLACE[0], rate, PLACE[2], MELT, 50.0)
    assert CriticalLiquid(LINEAR).suction(np.array([0.02]))[0] / value[0] ** 2 == pytest.approx(
        0.4552843, rel=2e-7
    )


def test_the_integrals_of_scheil_agree_with_adaptive_quadrature():
    path = FreezingPath(ScheilLaw(0.2, 660.3), 500.0, 640.0)
    start = 660.3 - 20.3 * 0.05 ** (0.2 - 1.0)
    assert start < 500.0  # the cut-off lies in the eutectic: from the solidus on
    for cut_off, low in ((0.05, 500.0), (0.2, 660.3 - 20.3 * 0.2 ** (0.2 - 1.0))):

        def solid(t):
            return 1.0 - ((660.3 - t) / 20.3) ** (1.0 / (0.2 - 1.0))

        found = MushSuction.of(path, cut_off)
        exact = quad(lambda t: solid(t) ** 2 / (1.0 - solid(t)) ** 2, low, 640.0)[0]
        assert found.shrinking == pytest.approx(exact, rel=1e-8)
        double = dblquad(
            lambda inner, t: solid(inner) * solid(t) ** 2 / (1.0 - solid(t)) ** 3,
            low, 640.0, low, lambda t: t,
        )[0]  # fmt: skip
        assert found.straining == pytest.approx(double, rel=1e-7)


def test_the_margin_hangs_on_the_cut_off():
    rates = [MushSuction.of(LINEAR, cut).critical_rate(*PLACE, MELT)[0] for cut in CUT_OFFS]
    assert rates[0] > 2.0 * rates[1] > 100.0 * rates[2] > 0.0
    rate = rate_across(np.array([2e-3, -1e-3]), np.array([0.1, 0.1]))
    np.testing.assert_allclose(rate, [0.02, 0.0], rtol=1e-14)
    margin = tearing_margin(rate, np.array([0.04, 0.04]))
    np.testing.assert_allclose(margin, [0.5, 0.0], rtol=1e-14)
    alone = tearing_margin(np.array([0.01, 0.0, np.nan]), np.zeros(3))
    np.testing.assert_array_equal(alone, [np.inf, np.inf, np.nan])
