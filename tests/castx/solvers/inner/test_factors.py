"""Which factors a solver takes, against the dense algebra that they stand for."""

from __future__ import annotations

from petsc4py import PETSc

import numpy as np
import pytest
from scipy import sparse

from castx.solvers.inner.direct import DirectSolver
from castx.solvers.inner.factors import DISSECTION, ORDERING
from tests.castx.solvers.distributed import options, vector
from tests.castx.solvers.inner.systems import LOCAL, PREFIX, applied

LEAST_FILL = 2
"""What MUMPS chooses for few unknowns by itself."""


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


def stencil(shape, unknowns):
    """Return a matrix of a grid whose nodes know of all nodes around them."""
    found = sparse.csr_array(np.eye(unknowns) + 0.1)
    for count in shape:
        line = sparse.diags_array([1.0, 4.0, 1.0], offsets=[-1, 0, 1], shape=(count, count))
        found = sparse.kron(found, line, "csr")
    return found


@pytest.mark.parametrize(
    ("shape", "given", "expected"),
    [((8, 8, 9), {}, DISSECTION), ((23, 23), {}, LEAST_FILL),
     ((4, 4, 4), {}, LEAST_FILL), ((8, 8, 9), {"mat_mumps_icntl_7": 6}, 6)],
)  # fmt: skip
@pytest.mark.serial
def test_long_rows_are_eliminated_by_dissection_unless_a_case_says_otherwise(
    comm, shape, given, expected
):
    """A grid in space, one in the plane, and one in space with an option of a case."""
    values, solver = stencil(shape, 2), DirectSolver(comm, PREFIX)
    size = values.shape[0]
    A = PETSc.Mat().createAIJ((size, size), csr=(values.indptr, values.indices, values.data))
    b = vector(comm, np.cos(np.arange(size)))
    x = b.duplicate()
    with options(PREFIX, {**solver.defaults, **given}):
        solver.set_up(A, np.zeros(size, dtype=bool))
    solver.solve(b, x)
    np.testing.assert_allclose(values @ x.array_r, b.array_r, rtol=1e-9, atol=1e-12)
    assert solver._ksp.pc.getFactorMatrix().getMumpsInfog(ORDERING) == expected
    for item in (solver, A, b, x):
        item.destroy()
