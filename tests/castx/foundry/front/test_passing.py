"""Passing of fronts: one of a eutectic travels at constant speed, so that it passes x at x/v."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from castx.foundry.front.control_volumes import ControlVolumes
from castx.foundry.front.excess import PLACES, WEIGHTS, Step
from castx.foundry.front.levels import Level
from castx.foundry.front.passing import Front
from castx.tables import Table
from tests.castx.fakes import slab_mesh
from tests.castx.foundry.front.means import control_volume_means

CAPACITY, LATENT = 2.7e6, 9.8e8
EUTECTIC, LIQUIDUS, LEFT = 560.0, 615.0, 0.4
SPEED, BEHIND, AHEAD = 1e-3, 30e3, 8e3
CENTRE = PLACES.index(0.0)


class Curve:
    """f_s linear from the liquidus to the eutectic, where the rest freezes."""

    knots = np.array([0.0, EUTECTIC, EUTECTIC, LIQUIDUS, 3000.0])
    fractions = np.array([1.0, 1.0, 1.0 - LEFT, 0.0, 0.0])
    heights = CAPACITY * knots + LATENT * (1.0 - fractions)

    def enthalpy(self, temperature):
        solid = CAPACITY * temperature
        liquid = Table(self.knots[2:], self.heights[2:])(temperature)
        return np.where(temperature < EUTECTIC, solid, liquid)

    def temperature(self, enthalpy):
        return Table(self.heights, self.knots)(enthalpy)

    def solid_fraction(self, enthalpy):
        return Table(self.heights, self.fractions)(enthalpy)


def enthalpies(body, time):
    """Return nodal enthalpies while a eutectic front stands at x = v t."""

    def enthalpy(x):
        distance = x[:, 0] - SPEED * time
        slope = np.where(distance > 0.0, AHEAD, BEHIND)
        return Curve().enthalpy(EUTECTIC + slope * distance)

    return control_volume_means(body, enthalpy)


def passed(comm, size, step):
    """Return the times of passing of the nodes off the ends, and their x."""
    body = slab_mesh(comm, size, 6 * size).bodies["casting"]
    front = Front(body, Curve(), [Level.of(Curve(), 1.0)], ControlVolumes(body))
    nodes = len(body.points)
    times, before = np.full((3, nodes), np.nan), np.zeros((3, nodes), dtype=bool)
    instants = np.arange(-size / SPEED, 6 * size / SPEED, step)
    old = enthalpies(body, instants[0])
    for time in instants[:-1]:
        new = enthalpies(body, time + step)
        parts = front.parts(Step(old, new))
        found = front.passage(Step(old, new), parts, before[None])
        frozen, share = found.frozen[0], found.share[0]
        times[frozen] = time + step * share[frozen]
        before |= frozen
        old = new
    inside = (body.points[:, 0] > 1.5 * size) & (body.points[:, 0] < 4.5 * size)
    return times[:, inside], body.points[inside, 0]


def test_a_eutectic_front_passes_when_it_is_at_the_node(comm):
    size = 1e-3
    times, x = passed(comm, size, 0.05)
    late = (times - x / SPEED) * SPEED / size
    assert comm.allreduce(float(np.abs(late[CENTRE]).max(initial=0.0)), MPI.MAX) < 0.07
    assert comm.allreduce(float(np.abs(np.array(WEIGHTS) @ late).max(initial=0.0)), MPI.MAX) < 0.07
    assert comm.allreduce(float(late[0].max(initial=-1.0)), MPI.MAX) < -0.3
    assert comm.allreduce(float(late[2].min(initial=1.0)), MPI.MIN) > 0.3


@pytest.mark.ranks
def test_what_freezes_in_one_step_passes_within_it_and_remelts(comm):
    body = slab_mesh(comm, 2e-3, 0.01).bodies["casting"]
    levels = [Level.of(Curve(), fraction) for fraction in (0.0, 0.9, 1.0)]
    front = Front(body, Curve(), levels, ControlVolumes(body))
    x = body.points[:, 0]
    hot = Curve().enthalpy(LIQUIDUS + 20.0 + 3e3 * x)
    cold = Curve().enthalpy(300.0 + 8e3 * x)
    none = np.zeros((3, 3, x.size), dtype=bool)
    step = Step(hot, cold)
    parts = front.parts(step)
    found = front.passage(step, parts, none)
    assert found.frozen.all() and not found.remelted.any()
    shares = found.share[:, CENTRE]
    assert (np.diff(shares, axis=0) >= 0.0).all() and (shares < 1.0).all() and (shares > 0.0).all()
    gradient = front.gradient(step, found.frozen[1, CENTRE], shares[1], parts)
    np.testing.assert_allclose(gradient, 8e3, rtol=1e-3)  # the liquid at the start has no say
    back = Step(cold, hot)
    found = front.passage(back, front.parts(back), ~none)
    assert found.remelted.all() and not found.frozen.any()


class CountedCurve(Curve):
    """The curve, and how many temperatures it was asked for."""

    asked = 0

    def temperature(self, enthalpy):
        self.asked += np.size(enthalpy)
        return super().temperature(enthalpy)


@pytest.mark.ranks
def test_levels_at_one_temperature_are_followed_once(comm):
    """The solidus and f_s = 0.9 of a eutectic pass together, for the price of one."""
    body = slab_mesh(comm, 2e-3, 0.01).bodies["casting"]
    nodes, found, prices = len(body.points), [], []
    step = Step(enthalpies(body, 2.2), enthalpies(body, 6.1))
    for fractions in ((1.0,), (0.9, 1.0)):
        curve = CountedCurve()
        front = Front(
            body,
            curve,
            [Level.of(Curve(), fraction) for fraction in fractions],
            ControlVolumes(body),
        )
        passed = np.broadcast_to(front.passed(step.start)[:1], (len(fractions), 3, nodes))
        found.append(front.passage(step, front.parts(step), passed))
        prices.append(curve.asked)
    alone, both = found
    for name in ("frozen", "remelted", "share"):
        for level in getattr(both, name):
            np.testing.assert_array_equal(level, getattr(alone, name)[0])
    assert comm.allreduce(int(alone.frozen.sum())) > 0
    assert prices[0] == prices[1]


@pytest.mark.ranks
def test_a_front_comes_with_latent_heat_and_not_with_rounding(comm):
    """The superheat of all liquid vanishes but for rounding, and then a tenth of it freezes."""
    body = slab_mesh(comm, 1e-3, 6e-3).bodies["casting"]
    level = Level.of(Curve(), 1.0)
    front = Front(body, Curve(), [level], ControlVolumes(body))
    inside = body.points[:, 0] < 5.5e-3
    superheat = 1e-10 * level.hot * (1.0 + body.points[:, 0] / 1e-3)
    rest, gone = level.hot + superheat, level.hot + 0.1 * superheat - 1e-10 * level.hot
    before = np.zeros((1, len(PLACES), len(rest)), dtype=bool)
    for after, entered in ((gone, False), (gone - 0.1 * (level.hot - level.cold), True)):
        step = Step(rest, after)
        found = front.passage(step, front.parts(step), before)
        assert (found.frozen[0, 0, inside] == entered).all()
