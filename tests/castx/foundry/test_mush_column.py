"""Suction along a column of mush against exact values (specification of the foundry, 2.8)."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from castx.foundry.mush_column import MushResistance, column_suction
from castx.foundry.porosity import Melt
from castx.proof.verification.heat.freezing_range import FreezingRange

pytestmark = pytest.mark.serial

LENGTH, SPEED, BETA, CUT = 5e-3, 1e-3, 0.06, 0.02
MUSH = MushResistance(Melt(1e-3, BETA), 50e-6, CUT)
FREEZING = SPEED / LENGTH


def strip(elements, freezing=FREEZING, stretching=0.0, strained_from=0.0):
    """Return liquid fraction and suction of a strip with g = x/L and a node at the cut-off."""
    x = np.unique(np.append(np.linspace(0.0, LENGTH, elements + 1), CUT * LENGTH))
    if strained_from:  # a jump of the rate: two nodes in one place
        x = np.sort(np.append(x, strained_from * LENGTH))
    rate = np.full(x.size, stretching)
    if strained_from:
        rate[: int(np.searchsorted(x, strained_from * LENGTH, side="right")) - 1] = 0.0
    g = x / LENGTH
    return g, column_suction(x, 1.0 - g, np.full(x.size, freezing), rate, MUSH)


def at_cut_and_root(elements, **given):
    g, suction = strip(elements, **given)
    return suction[int(np.argmin(np.abs(g - CUT)))], suction[0]


@pytest.mark.parametrize("elements", [1, 2, 3, 7, 50, 1000])
def test_suction_by_shrinkage_is_exact_on_any_mesh(elements):
    found = at_cut_and_root(elements)
    np.testing.assert_allclose(found, [910.5686, 1429.1846], rtol=1e-7)


def test_a_fed_end_has_no_suction():
    assert strip(3)[1][-1] == 0.0


def test_suction_by_strain_and_its_falling_error():
    wanted = np.array([803.0116, 1260.9495])
    errors = []
    for elements in (5, 10, 400):
        found = at_cut_and_root(elements, freezing=0.0, stretching=0.01)
        errors.append(np.abs(found / wanted - 1.0).max())
    assert errors[0] < 3e-3 and errors[1] < errors[0] / 2.8 and errors[2] < 3e-6


def test_both_and_the_rate_at_which_the_cut_off_reaches_two_kilopascal():
    found = at_cut_and_root(2000, stretching=0.01)
    np.testing.assert_allclose(found, [1713.5802, 2690.1342], rtol=1e-6)
    shrinkage, _ = at_cut_and_root(2000)
    strain, _ = at_cut_and_root(2000, freezing=0.0, stretching=1.0)
    assert (2e3 - shrinkage) / strain == pytest.approx(0.01356682, rel=1e-6)


def test_the_rate_if_only_what_has_not_grown_together_is_strained():
    errors = []
    for elements in (2000, 8000):
        shrinkage, _ = at_cut_and_root(elements)
        above, _ = at_cut_and_root(elements, freezing=0.0, stretching=1.0, strained_from=CUT)
        errors.append(abs((2e3 - shrinkage) / above / 0.03006523 - 1.0))
    assert errors[1] < 1e-5 and errors[0] > 10.0 * errors[1]


def test_the_permeability_and_its_means():
    liquid = np.array([0.5, CUT, 0.01])
    exact = 2.5e-9 / 180.0 * np.array([0.5, CUT**3 / 0.98**2, CUT**3 / 0.98**2])
    exact[0] = 2.5e-9 / 180.0 * 0.5**3 / 0.5**2
    np.testing.assert_allclose(MUSH.permeability(liquid), exact, rtol=1e-14)
    for ends in (
        (0.3, 0.6), (0.01, 0.05), (0.0, 0.015), (0.2, 0.2005), (0.6, 0.3),
        (0.018, 0.023),  # Gauss's rule misses the kink
        (0.999, 0.9995),  # differences of primitives are rounding
    ):  # fmt: skip

        def drag(g):
            return g / MUSH.permeability(np.array(g))

        kink = [CUT] if min(ends) < CUT < max(ends) else None
        mean = quad(drag, *ends, points=kink, epsabs=0, epsrel=1e-12)[0] / (ends[1] - ends[0])
        found = MUSH.mean_resistance(*(np.array([end]) for end in ends))
        np.testing.assert_allclose(found, mean / (0.5 * sum(ends)), rtol=1e-9)
    solid = MUSH.mean_resistance(np.zeros(1), np.zeros(1))
    np.testing.assert_allclose(solid, 1.0 / MUSH.permeability(np.zeros(1)), rtol=1e-12)


@pytest.fixture(scope="module")
def profile():
    """Return η, f and its freezing rate times t of the alloy on a chilled wall (V3)."""
    wall = FreezingRange()
    eta = np.linspace(*wall.fronts, 20001)
    width = wall.liquidus - wall.solidus
    f = np.clip((wall.liquidus - wall.temperature(eta, 1.0)) / width, 0.0, 1.0)
    return eta, f, -np.gradient(f, eta, edge_order=2) * eta / 2.0


@pytest.mark.parametrize("time", [1.0, 75.0])
def test_the_suction_of_a_mush_that_widens_is_constant_in_time(profile, time):
    """V3 with λ2 = 20 µm, μ = 1.2e-3 and β = 0.0625."""
    eta, f, rate = profile
    wanted = {0.3: 187.864, 0.2: 438.530, 0.1: 1361.013, 0.05: 3447.443, 0.02: 10129.74}
    mush = MushResistance(Melt(1.2e-3, 0.0625), 20e-6, 0.01)
    nodes = np.interp(1.0 - np.array(list(wanted)), f[::-1], eta[::-1])
    errors = []
    ends = np.sort(np.concatenate([eta[[0, -1]], nodes]))
    for parts in (8, 16, 32):
        inner = [np.linspace(*pair, parts + 1)[:-1] for pair in pairwise(ends)]
        at = np.concatenate([*inner, eta[-1:]])
        fraction, freezing = np.interp(at, eta, f), np.interp(at, eta, rate) / time
        found = column_suction(at * np.sqrt(time), fraction, freezing, np.zeros(at.size), mush)
        here = [int(np.argmin(np.abs(at - node))) for node in nodes]
        errors.append(np.abs(found[here] / np.array(list(wanted.values())) - 1.0).max())
    assert errors[2] < 1e-3 and errors[0] > 3.5 * errors[1] > 12.0 * errors[2]


def test_how_far_pressure_evens_out_in_a_step():
    """τ_D = Δt K/μ of one second, from 5 % solid, which counts as liquid, to the cut-off."""
    liquid = 1.0 - np.array([0.5, 0.7, 0.9, 0.98, 0.05])
    evened = MUSH.permeability(liquid) / MUSH.melt.viscosity
    expected = [6.944e-9, 7.653e-10, 1.715e-11, 1.157e-13, 4.763e-6]
    np.testing.assert_allclose(evened, expected, rtol=3e-4)  # four digits
    assert MUSH.permeability(np.array(0.001)) == MUSH.permeability(np.array(CUT))
