"""Foundry quantities of a temperature field that travels with constant speed, where all is known.

T = T_f + G (x - v t): gradient G, cooling rate G v, Niyama √(G/v), and the time (T_L - T_S)/(G v)
between liquidus and solidus.
"""

from mpi4py import MPI

import numpy as np
import pytest

from castx.foundry.front.levels import Level
from castx.foundry.front.solidification import LEVELS, BodySolidification, Solidification
from castx.tables import Table
from tests.castx.fakes import FakeSnapshot, cylinder_mesh, slab_mesh
from tests.castx.foundry.front.means import control_volume_means

GRADIENT, SPEED = 2000.0, 1e-3
SOLIDUS, LIQUIDUS = 560.0, 615.0
CAPACITY, LATENT = 2.7e6, 9.8e8


class Curve:
    """H = C T + L (1 - f_s), f_s linear between solidus and liquidus."""

    def enthalpy(self, temperature):
        return CAPACITY * temperature + LATENT * (1.0 - self.fraction(temperature))

    def fraction(self, temperature):
        return np.clip((LIQUIDUS - temperature) / (LIQUIDUS - SOLIDUS), 0.0, 1.0)

    def temperature(self, enthalpy):
        temperatures = np.array([0.0, SOLIDUS, LIQUIDUS, 2000.0])
        return Table(self.enthalpy(temperatures), temperatures)(enthalpy)

    def solid_fraction(self, enthalpy):
        return self.fraction(self.temperature(enthalpy))


def travelling(mesh, time, step, speed=SPEED):
    def temperature(x):
        return 640.0 + GRADIENT * (x[:, 0] - speed * time)

    means = control_volume_means(mesh.bodies["casting"], lambda x: Curve().enthalpy(temperature(x)))
    return FakeSnapshot(time, step, mesh, formulas={"enthalpy": lambda x: means})


def follow(comm, size=1e-3, length=0.02, step_size=0.25, start=0.0, end=60.0):
    mesh = slab_mesh(comm, size, length)
    solidification = BodySolidification(mesh.bodies["casting"], Curve())
    for step in range(round((end - start) / step_size) + 1):
        state = travelling(mesh, start + step * step_size, step)
        solidification.update(state, "casting")
    return mesh, solidification


def extremes(comm, values):
    low, high = float(values.min(initial=np.inf)), float(values.max(initial=-np.inf))
    return comm.allreduce(low, MPI.MIN), comm.allreduce(high, MPI.MAX)


def test_levels_are_where_the_fraction_says():
    levels = [Level.of(Curve(), fraction) for fraction in LEVELS]
    temperatures = LIQUIDUS - np.array(LEVELS) * (LIQUIDUS - SOLIDUS)
    found = [[level.temperature, level.cold, level.hot] for level in levels]
    enthalpies = Curve().enthalpy(temperatures)
    exact = np.column_stack([temperatures, enthalpies, enthalpies])
    np.testing.assert_allclose(found, exact, rtol=1e-11)


def test_a_travelling_front_has_its_exact_quantities(comm):
    sizes = {"size": 2.5e-4, "length": 3e-3, "step_size": 0.1, "start": 10.0, "end": 45.0}
    mesh, solidification = follow(comm, **sizes)
    x = mesh.bodies["casting"].points[:, 0]
    inside = (x > 5e-4) & (x < 2.5e-3)  # nodes have means around them, one-sided ones at both ends
    time = (LIQUIDUS - SOLIDUS) / (GRADIENT * SPEED)
    for values, exact in (
        (solidification.solidification_time(), time),
        (solidification.gradient(), GRADIENT),
        (solidification.cooling_rate(), GRADIENT * SPEED),
        (solidification.niyama(), np.sqrt(GRADIENT / SPEED)),
    ):
        assert extremes(comm, values[inside]) == pytest.approx((exact, exact), rel=1e-3)


@pytest.mark.parametrize("step_size", [0.7, 7.0, 70.0])
def test_times_do_not_depend_on_the_step_when_heat_leaves_steadily(comm, step_size):
    mesh = slab_mesh(comm, 5e-3)
    solidification = BodySolidification(mesh.bodies["casting"], Curve())
    start, end = Curve().enthalpy(np.array([LIQUIDUS, SOLIDUS]))
    rate = (start - end) / 33.3
    for step in range(round(70.0 / step_size) + 1):
        enthalpy = start + rate * (11.1 - step * step_size)
        formulas = {"enthalpy": lambda x, value=enthalpy: np.full(len(x), value)}
        state = FakeSnapshot(step * step_size, step, mesh, formulas=formulas)
        solidification.update(state, "casting")
    np.testing.assert_allclose(solidification.solidification_time(), 33.3, rtol=1e-10)


def test_what_has_not_passed_is_not_a_number_and_remelting_wipes(comm):
    mesh, solidification = follow(comm, end=25.0)
    points = mesh.bodies["casting"].nodes.tabulate_dof_coordinates()[:, 0]
    done = 640.0 + GRADIENT * (points - SPEED * 25.0) <= SOLIDUS
    np.testing.assert_array_equal(done, np.isfinite(solidification.solidification_time()))
    assert np.isnan(solidification.niyama()[points > 0.015]).all()
    for step in range(1, 26):
        solidification.update(travelling(mesh, 25.0 - step, step), "casting")
    assert np.isnan(solidification.solidification_time()).all()
    assert np.isnan(solidification.gradient()).all()


@pytest.mark.ranks
def test_a_body_that_does_not_melt_has_none(comm):
    mesh = cylinder_mesh(comm, size=5e-3)
    solidification = Solidification(mesh, {"casting": Curve()})
    assert np.isnan(solidification.nodal("mould", "niyama")).all()
