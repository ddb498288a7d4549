"""Solver of one block against dense algebra."""

from __future__ import annotations

import numpy as np

from castx.solvers.inner.block_solver import BlockSolver
from tests.castx.solvers.inner.systems import PREFIX, applied, in_second, two_blocks


def test_a_block_is_solved_for_with_zeros_elsewhere(comm, dense):
    b, second = np.sin(1.0 + np.arange(len(dense))), in_second(comm)
    solver = BlockSolver(comm, PREFIX, two_blocks(comm)[1])
    assert solver.is_exact
    expected = np.zeros(len(b))
    expected[second] = np.linalg.solve(dense[np.ix_(second, second)], b[second])
    np.testing.assert_allclose(applied(comm, solver, dense, b), expected, rtol=1e-12)
    solver.destroy()
