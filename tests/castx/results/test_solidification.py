"""Foundry quantities of a temperature field that travels with constant speed, where all is known.

T = T_f + G (x - v t): gradient G, cooling rate G v, Niyama √(G/v), and the time (T_L - T_S)/(G v)
between liquidus and solidus.
"""

from mpi4py import MPI

import numpy as np
import pytest

from castx.results.solidification import LEVELS, BodySolidification, Solidification, thresholds_of
from castx.tables import Table
from tests.castx.fakes import FakeSnapshot, cylinder_mesh, slab_mesh

GRADIENT, SPEED = 2000.0, 1e-3
SOLIDUS, LIQUIDUS = 560.0, 615.0
CAPACITY, LATENT = 2.7e6, 9.8e8


class Curve:
    """H = C T + L (1 - f_s), f_s linear between solidus and liquidus."""

    def enthalpy(self, temperature):
        return CAPACITY * temperature + LATENT * (1.0 - self.fraction(temperature))

    def fraction(self, temperature):
        return np.clip((LIQUIDUS - temperature) / (LIQUIDUS - SOLIDUS), 0.0, 1.0)

    def solid_fraction(self, enthalpy):
        temperatures = np.array([0.0, SOLIDUS, LIQUIDUS, 1000.0])
        table = Table(self.enthalpy(temperatures), self.fraction(temperatures))
        return table(enthalpy)


def travelling(mesh, time, step, speed=SPEED):
    def temperature(x):
        return 640.0 + GRADIENT * (x[:, 0] - speed * time)

    curve = Curve()
    return FakeSnapshot(
        time,
        step,
        mesh,
        formulas={
            "temperature": temperature,
            "enthalpy": lambda x: curve.enthalpy(temperature(x)),
            "solid_fraction": lambda x: curve.fraction(temperature(x)),
        },
    )


def follow(comm, step_size=0.1, end=60.0):
    mesh = slab_mesh(comm, 1e-3)
    solidification = BodySolidification(mesh.bodies["casting"], thresholds_of(Curve()))
    for step in range(round(end / step_size) + 1):
        solidification.update(travelling(mesh, step * step_size, step), "casting")
    return mesh, solidification


def extremes(comm, values):
    low, high = float(values.min(initial=np.inf)), float(values.max(initial=-np.inf))
    return comm.allreduce(low, MPI.MIN), comm.allreduce(high, MPI.MAX)


def test_thresholds_are_where_the_fraction_says():
    thresholds = thresholds_of(Curve())
    temperatures = LIQUIDUS - np.array(LEVELS) * (LIQUIDUS - SOLIDUS)
    np.testing.assert_allclose(thresholds, Curve().enthalpy(temperatures), rtol=1e-12)


def test_a_travelling_front_has_its_exact_quantities(comm):
    _, solidification = follow(comm)
    time = (LIQUIDUS - SOLIDUS) / (GRADIENT * SPEED)
    for values, exact in (
        (solidification.solidification_time(), time),
        (solidification.gradient(), GRADIENT),
        (solidification.cooling_rate(), GRADIENT * SPEED),
        (solidification.niyama(), np.sqrt(GRADIENT / SPEED)),
    ):
        assert extremes(comm, values) == pytest.approx((exact, exact), rel=1e-3)


@pytest.mark.parametrize("step_size", [0.7, 7.0, 70.0])
def test_times_do_not_depend_on_the_step_when_heat_leaves_steadily(comm, step_size):
    mesh = slab_mesh(comm, 5e-3)
    thresholds = thresholds_of(Curve())
    solidification = BodySolidification(mesh.bodies["casting"], thresholds)
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


def test_a_body_that_does_not_melt_has_none(comm):
    mesh = cylinder_mesh(comm, size=5e-3)
    solidification = Solidification(mesh, {"casting": thresholds_of(Curve())})
    assert np.isnan(solidification.nodal("mould", "niyama")).all()
