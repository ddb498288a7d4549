"""PETSc options of a case act, each under its own prefix, and leave nothing behind."""

from __future__ import annotations

from petsc4py import PETSc

import pytest

from castx.errors import ConvergenceError
from tests.coupled_cases import cylinder, simulation


def first_step(comm, **options):
    """Return the iterations of each linear solve of the mechanics in the first coupled step.

    Args:
        comm: ranks.
        options: PETSc options by the part of the solver.
    """
    run = simulation(comm, cylinder({"solver": {"linear": "direct", **options}}))
    equilibrium, reports = run.problem.mechanics.equilibrium, []
    solve = equilibrium.solve
    equilibrium.solve = lambda time: reports.append(solve(time)) or reports[-1]
    run.problem.advance(0.0, 0.05, 2)
    run.destroy()
    return [iterations for report in reports for iterations in report.linear_solves]


def test_options_of_the_mechanics_reach_the_outer_krylov_method(comm) -> None:
    exact = first_step(comm)
    loose = first_step(comm, mechanics={"ksp_rtol": 0.5})
    assert sum(loose) / len(loose) < sum(exact) / len(exact)


def test_options_of_the_contact_reach_the_solver_of_the_bodies(comm) -> None:
    exact = first_step(comm)
    rough = first_step(comm, contact={"pc_type": "bjacobi"})
    # The first solve: later ones start so near their solution that rounding stops them.
    assert rough[0] > 2 * exact[0]


def test_options_of_the_heat_reach_its_linear_solver(comm) -> None:
    weak = {"ksp_type": "gmres", "pc_type": "none", "ksp_max_it": 1, "ksp_rtol": 1e-12}
    with pytest.raises(ConvergenceError, match=r"the heat problem did not converge: .*linear"):
        first_step(comm, heat=weak)


def test_no_option_stays_in_the_database(comm) -> None:
    before = PETSc.Options().getAll()
    first_step(comm, mechanics={"ksp_rtol": 0.1}, heat={"snes_max_it": 40})
    assert PETSc.Options().getAll() == before
