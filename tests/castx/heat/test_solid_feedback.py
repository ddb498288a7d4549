"""Solid fractions of whole bodies in the heat problem: means, derivatives, linear solves."""

from __future__ import annotations

from petsc4py import PETSc

import numpy as np
import pytest

from castx.heat.solid_feedback import couple_step
from tests.castx.heat.heat_cases import (
    SOLID,
    advanced,
    balance_under_law,
    cylinder,
    problem_under_law,
)


@pytest.mark.ranks
@pytest.mark.parametrize("linear", ["direct", "iterative"])
def test_linear_solvers_agree_where_a_whole_body_acts_on_every_pair(comm, linear):
    mesh = cylinder(comm)
    heat, reference = problem_under_law(mesh, SOLID, linear=linear), problem_under_law(mesh, SOLID)
    advanced(heat, mesh, [2.0, 10.0])
    advanced(reference, mesh, [2.0, 10.0])
    heats = [h.totals()["casting/mould.heat"] for h in (heat, reference)]
    assert heats[0] == pytest.approx(heats[1], rel=1e-7)


@pytest.mark.ranks
def test_mean_solid_fraction_and_its_derivative(comm):
    """Against the sum over all nodes, and differences of it along one direction."""
    balance = balance_under_law(cylinder(comm, size=8e-3), SOLID)
    feedback, body = balance.exchanges.feedback, balance.bodies[0]
    assert balance.exchanges.fed_back == balance.exchanges.under_law
    owned = body.owned
    total = comm.allreduce(body.volumes.sum())

    def mean() -> float:
        local = body.volumes @ body.solid_fraction.x.array[:owned]
        return float(comm.allreduce(local) / total)

    assert 0.1 < mean() < 0.9
    assert feedback.means() == pytest.approx([mean(), 0.0])
    state = body.enthalpy.x.array[:owned].copy()
    direction = 1e3 * np.cos(np.arange(owned))
    ones, slope = balance.layout.create_vector(), balance.layout.create_vector()
    ones.array[:] = 1.0
    feedback.mean_slope(0, ones, slope)
    found = comm.allreduce(float(slope.array_r[balance.layout.local_slice(0)] @ direction))
    ends = []
    for sign in (1.0, -1.0):
        body.set_enthalpy(state + sign * direction)
        ends.append(mean())
    assert found == pytest.approx(0.5 * (ends[0] - ends[1]), rel=1e-6)
    assert (slope.array_r[balance.layout.local_slice(1)] == 0.0).all()


@pytest.mark.serial
def test_columns_complete_a_solution_as_in_dense_algebra():
    """(J + U Vᵀ) y = F with two columns, by the solver of J alone."""
    rng = np.random.default_rng(3)
    J, U, V = rng.normal(size=(7, 7)) + 9.0 * np.eye(7), rng.normal(size=(7, 2)), np.ones((7, 2))
    V[:, 1], F = rng.normal(size=7), rng.normal(size=7)
    matrix = PETSc.Mat().createDense((7, 7), array=J.copy(), comm=PETSc.COMM_SELF)
    solver = PETSc.KSP().create(PETSc.COMM_SELF)
    solver.setOperators(matrix)
    solver.setType("preonly")
    solver.pc.setType("lu")

    def vector(values):
        return PETSc.Vec().createWithArray(values.copy(), comm=PETSc.COMM_SELF)

    y = vector(np.linalg.solve(J, F))
    couple_step([(vector(U[:, k]), vector(V[:, k])) for k in range(2)], y, solver)
    np.testing.assert_allclose(y.array, np.linalg.solve(J + U @ V.T, F), rtol=1e-11)
