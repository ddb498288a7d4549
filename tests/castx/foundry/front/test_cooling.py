"""Cooling in a window around a level: exact rates, what counts, remelting, saved states."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from castx.foundry.front.control_volumes import ControlVolumes
from castx.foundry.front.cooling import CoolingWindow, WindowCooling
from castx.foundry.front.excess import Step
from castx.foundry.front.levels import Level
from castx.foundry.front.solidification import BodySolidification
from castx.tables import Table
from tests.castx.fakes import FakeSnapshot, slab_mesh
from tests.castx.foundry.front import test_passing, test_solidification

LINEAR, EUTECTIC = test_solidification.Curve(), test_passing.Curve()
SOLIDUS, LIQUIDUS = 560.0, 615.0
RANGE = LIQUIDUS - SOLIDUS
AT = LIQUIDUS - 0.9 * RANGE
SIZE = 1e-3


class Isothermal:
    """A metal that freezes at one temperature."""

    knots, heights = np.array([0.0, 660.0, 660.0, 3000.0]), np.array([0.0, 2e9, 3e9, 1e10])

    def enthalpy(self, temperature):
        hot = Table(self.knots[2:], self.heights[2:])(temperature)
        cold = Table(self.knots[:2], self.heights[:2])(temperature)
        return np.where(temperature < 660.0, cold, hot)

    def temperature(self, enthalpy):
        return Table(self.heights, self.knots)(enthalpy)

    def solid_fraction(self, enthalpy):
        return Table(self.heights, np.array([1.0, 1.0, 0.0, 0.0]))(enthalpy)


@pytest.mark.serial
@pytest.mark.parametrize(
    ("fraction", "high", "low"), [(0.9, 0.85, 0.95), (0.0, 0.0, 0.05), (0.98, 0.93, 1.0)]
)
def test_the_window_lies_around_the_level_inside_the_freezing_range(fraction, high, low):
    window = CoolingWindow.around(LINEAR, Level.of(LINEAR, fraction))
    fractions = np.array([high, fraction, low])
    exact = LINEAR.enthalpy(LIQUIDUS - fractions * RANGE)
    np.testing.assert_allclose(window.enthalpies, exact, rtol=1e-9)
    assert window.width == pytest.approx((low - high) * RANGE, rel=1e-9)


@pytest.mark.serial
def test_there_is_no_window_where_metal_freezes_at_one_temperature():
    metal = Isothermal()
    assert CoolingWindow.around(metal, Level.of(metal, 0.9)) is None
    assert CoolingWindow.around(EUTECTIC, Level.of(EUTECTIC, 0.9)) is None


@pytest.mark.serial
def test_a_window_ends_where_the_eutectic_begins():
    """The level lies 2 K above it, nearer than half of the window."""
    window = CoolingWindow.around(EUTECTIC, Level.at(EUTECTIC, 562.0))
    assert window.width == pytest.approx(2.0 + 0.05 * RANGE, rel=1e-9)
    assert window.enthalpies[2] == pytest.approx(EUTECTIC.heights[2], rel=1e-9)


def cooled(comm, temperatures):
    """Follow nodes through functions of x at instants one second apart."""
    body = slab_mesh(comm, SIZE, 4 * SIZE).bodies["casting"]
    window = CoolingWindow.around(LINEAR, Level.of(LINEAR, 0.9))
    cooling = WindowCooling(ControlVolumes(body), LINEAR, window)
    states = [LINEAR.enthalpy(of(body.points[:, 0])) for of in temperatures]
    for time, (start, end) in enumerate(pairwise(states)):
        cooling.follow(Step(start, end), float(time), time + 1.0)
    return cooling


def falling(rate, gradient=0.0):
    return [lambda x, t=t: 580.0 - rate * t + gradient * x for t in range(round(40 / rate) + 1)]


@pytest.mark.parametrize("rate", [0.7, 4.0, 20.0])
def test_the_rate_is_that_of_the_node_in_short_and_long_steps(comm, rate):
    """In steps of 20 K the whole window is passed within one."""
    cooling = cooled(comm, falling(rate))
    np.testing.assert_allclose(cooling.rate(), rate, rtol=1e-6)
    np.testing.assert_array_equal(cooling.weight(), 1.0)


@pytest.mark.ranks
@pytest.mark.parametrize(("share", "weight"), [(0.2, 1.0), (0.35, 0.6), (0.6, 0.0)])
def test_the_window_gives_way_to_the_front_where_it_is_steep_on_the_mesh(comm, share, weight):
    """Differences of temperature in a cell, in widths of the window of 5.5 K."""
    gradient = share * 0.1 * RANGE / SIZE
    cooling = cooled(comm, falling(1.0, gradient))
    np.testing.assert_allclose(cooling.spread, share * 0.1 * RANGE, rtol=1e-9)
    np.testing.assert_allclose(cooling.weight(), weight, atol=1e-9)


def test_before_the_end_of_the_window_it_does_not_count_and_remelting_deletes_it(comm):
    cooling = cooled(comm, falling(1.0)[:16])
    assert np.isfinite(cooling.passing).all() and np.isnan(cooling.rate()).all()
    np.testing.assert_array_equal(cooling.weight(), 0.0)
    back = [*falling(1.0), lambda x: 600.0 + 0.0 * x]
    assert np.isnan(cooled(comm, back).times).all()
    np.testing.assert_allclose(cooled(comm, [*back, *falling(2.0)]).rate(), 2.0, rtol=1e-6)


def exponential(mesh, time, step):
    """Return a state of a body that cools as a whole: -dT/dt = (T - 100)/60."""
    heat = LINEAR.enthalpy(np.array(100.0 + 540.0 * np.exp(-time / 60.0)))
    return FakeSnapshot(time, step, mesh, formulas={"enthalpy": lambda x: np.full(len(x), heat)})


def test_a_body_that_cools_as_a_whole_has_one_rate_also_after_a_restart(comm):
    mesh = slab_mesh(comm, SIZE, 4 * SIZE)
    whole, first, second = (BodySolidification(mesh.bodies["casting"], LINEAR) for _ in range(3))
    for step in range(19):
        for body in (whole, first):
            body.update(exponential(mesh, 0.5 * step, step), "casting")
    second.restore({name: saved.values for name, saved in first.saved().items()})
    for step in range(19, 60):
        for body in (whole, second):
            body.update(exponential(mesh, 0.5 * step, step), "casting")
    np.testing.assert_allclose(whole.cooling_rate(), (AT - 100.0) / 60.0, rtol=1e-3)
    np.testing.assert_array_equal(second.cooling_rate(), whole.cooling_rate())
    np.testing.assert_allclose(whole.niyama(), 0.0, atol=1e-9)
