"""PETSc options of a case act, each under its own prefix, and leave nothing behind."""

from __future__ import annotations

from petsc4py import PETSc

import pytest

from castx.errors import ConvergenceError
from tests.coupled_cases import cylinder, simulation


def first_step(comm, **options):
    """Return the report of the first coupled step with PETSc options by the part of the solver."""
    run = simulation(comm, cylinder({"solver": {"linear": "direct", **options}}))
    report = run.problem.advance(0.0, 0.05, 2)
    run.destroy()
    return report


def test_options_of_the_mechanics_reach_the_outer_krylov_method(comm) -> None:
    exact = first_step(comm)
    loose = first_step(comm, mechanics={"ksp_rtol": 0.5})
    assert loose.linear_iterations / loose.mechanics_iterations < (
        exact.linear_iterations / exact.mechanics_iterations
    )


def test_options_of_the_contact_reach_the_solver_of_the_bodies(comm) -> None:
    exact = first_step(comm)
    rough = first_step(comm, contact={"pc_type": "bjacobi"})
    assert rough.linear_iterations > 2 * exact.linear_iterations


def test_options_of_the_heat_reach_its_linear_solver(comm) -> None:
    weak = {"ksp_type": "gmres", "pc_type": "none", "ksp_max_it": 1, "ksp_rtol": 1e-12}
    with pytest.raises(ConvergenceError, match=r"the heat problem did not converge: .*linear"):
        first_step(comm, heat=weak)


def test_no_option_stays_in_the_database(comm) -> None:
    before = PETSc.Options().getAll()
    first_step(comm, mechanics={"ksp_rtol": 0.1}, heat={"snes_max_it": 40})
    assert PETSc.Options().getAll() == before
