"""Sweeps over blocks against the dense algebra that they stand for."""

from __future__ import annotations

import numpy as np
import pytest

from castx.solvers.inner.nest import MOST_CHANGED_IN_SWEEP, Block
from castx.solvers.inner.options import MULTIGRID
from castx.solvers.inner.sweep import BlockSweep
from tests.castx.solvers.distributed import index_set
from tests.castx.solvers.inner.systems import (
    LOCAL,
    PREFIX,
    applied,
    in_second,
    one_block,
    two_blocks,
)

EXACT = {1: one_block, 2: two_blocks}
"""Blocks that are solved for exactly, by their number."""


def test_a_sweep_is_one_iteration_of_block_gauss_seidel(comm, dense):
    b, second = np.cos(np.arange(len(dense))), in_second(comm)
    solver = BlockSweep(comm, PREFIX, two_blocks(comm))
    for changed in (dense, dense.T + np.diag(b)):
        x = np.zeros(len(b))
        for own, done in ((~second, None), (second, ~second)):
            right = b[own] if done is None else b[own] - changed[np.ix_(own, done)] @ x[done]
            x[own] = np.linalg.solve(changed[np.ix_(own, own)], right)
        np.testing.assert_allclose(applied(comm, solver, changed, b), x, rtol=1e-12)
    solver.destroy()


def test_a_sweep_over_one_exact_block_solves(comm, dense):
    b = np.cos(np.arange(len(dense)))
    solver = BlockSweep(comm, PREFIX, one_block(comm))
    np.testing.assert_allclose(applied(comm, solver, dense, b), np.linalg.solve(dense, b))
    solver.destroy()


@pytest.mark.ranks
@pytest.mark.parametrize("blocks", [1, 2])
def test_factors_are_symmetric_until_a_matrix_is_not(comm, dense, blocks):
    """Factors of one triangle know nothing of the other one."""
    b = np.cos(np.arange(len(dense)))
    solver, exact = (BlockSweep(comm, PREFIX, EXACT[blocks](comm)) for _ in range(2))
    applied(comm, exact, dense, b)
    both = dense + dense.T
    for values, kind in ((both, "cholesky"), (2 * both, "cholesky"), (dense, "lu"), (both, "lu")):
        found = applied(comm, solver, values, b)
        kinds = {solver._solver_of(k).pc.getType() for k in range(blocks)}
        assert kinds == {kind}
        np.testing.assert_allclose(found, applied(comm, exact, values, b), rtol=1e-12)
    assert exact._solver_of(0).pc.getType() == "lu"
    for item in (solver, exact):
        item.destroy()


@pytest.mark.ranks
@pytest.mark.parametrize("blocks", [1, 2])
def test_factors_that_failed_leave_no_trace(comm, dense, blocks):
    """Of numbers that are none, as near a collapse."""
    b = np.cos(np.arange(len(dense)))
    solver = BlockSweep(comm, PREFIX, EXACT[blocks](comm))
    before = applied(comm, solver, dense, b)
    assert not np.isfinite(applied(comm, solver, np.nan * dense, b)).all()
    np.testing.assert_allclose(applied(comm, solver, dense, b), before)
    solver.destroy()


def soft_body(comm, stiff):
    """Return a block solved for by multigrid on each rank, some unknowns 10⁴ times stiffer."""
    count = LOCAL * comm.size
    springs = 2 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1)
    dense = springs + 1e4 * np.diag(np.tile(np.arange(LOCAL) < stiff, comm.size).astype(float))
    block = Block(index_set(comm, np.ones(count, dtype=bool)), np.ones((1, LOCAL)), MULTIGRID)
    return dense, BlockSweep(comm, PREFIX, [block])


def test_a_sweep_solves_for_stiff_unknowns_first(comm):
    """What it leaves of the residual of a stiff unknown is no more than rounding and the rest."""
    dense, solver = soft_body(comm, 2)
    assert solver.most_changed == MOST_CHANGED_IN_SWEEP
    b = np.cos(np.arange(len(dense)))
    found = applied(comm, solver, dense, b)
    assert solver.most_changed == 0
    np.testing.assert_allclose(found, np.linalg.solve(dense, b), atol=0.1)
    soft, same = soft_body(comm, 0)
    applied(comm, same, soft, b)
    assert same.most_changed == MOST_CHANGED_IN_SWEEP
    for item in (solver, same):
        item.destroy()
