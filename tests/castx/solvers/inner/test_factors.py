"""Which factors a solver takes, against the dense algebra that they stand for."""

from __future__ import annotations

import numpy as np
import pytest

from castx.solvers.inner.direct import DirectSolver
from tests.castx.solvers.inner.systems import LOCAL, PREFIX, applied


def kind(solver: DirectSolver) -> str:
    return str(solver._ksp.pc.getType())


@pytest.mark.ranks
def test_factors_are_symmetric_until_a_matrix_is_not(comm, dense):
    """Factors of one triangle know nothing of the other one."""
    b, both = np.cos(np.arange(len(dense))), dense + dense.T
    solver = DirectSolver(comm, PREFIX)
    for values, expected in (
        (both, "cholesky"), (2 * both, "cholesky"), (dense, "lu"), (both, "lu")
    ):  # fmt: skip
        found = applied(comm, solver, values, b)
        assert kind(solver) == expected
        np.testing.assert_allclose(found, np.linalg.solve(values, b), rtol=1e-12)
    solver.destroy()


@pytest.mark.ranks
def test_symmetric_factors_are_those_of_saddle_points_too(comm, dense):
    """Rows of multipliers, with nothing on their diagonal, as contact has them."""
    rows = np.tile(np.arange(LOCAL) >= LOCAL - 3, comm.size)
    saddle = dense + dense.T
    saddle[np.ix_(rows, rows)] = 0.0
    b = np.sin(np.arange(len(dense)))
    solver = DirectSolver(comm, PREFIX)
    np.testing.assert_allclose(applied(comm, solver, saddle, b), np.linalg.solve(saddle, b))
    assert kind(solver) == "cholesky"
    solver.destroy()


@pytest.mark.serial
def test_factors_of_another_package_stay_as_a_case_has_them(comm, dense):
    """PETSc's own factors, by an option."""
    b, both = np.cos(np.arange(len(dense))), dense + dense.T
    solver = DirectSolver(comm, PREFIX)
    solver.defaults = {**solver.defaults, "pc_factor_mat_solver_type": "petsc"}
    np.testing.assert_allclose(applied(comm, solver, both, b), np.linalg.solve(both, b))
    assert kind(solver) == "lu"
    solver.destroy()
