"""Inner solvers against the dense algebra that they stand for."""

from __future__ import annotations

import numpy as np
import pytest

from castx.solvers.blocks import (
    FACTORS,
    MOST_CHANGED_IN_SWEEP,
    MOST_STIFFENED,
    MULTIGRID,
    Block,
    Blocks,
    BlockSolver,
    BlockSweep,
    DirectSolver,
    largest_factor,
    orthonormal,
)
from tests.castx.solvers.distributed import gathered, index_set, matrix, options, vector

LOCAL = 8
PREFIX = "castx_test_inner_"


@pytest.fixture
def dense(comm):
    """Return an unsymmetric matrix with a strong diagonal."""
    size = LOCAL * comm.size
    values = np.random.default_rng(7).uniform(-1, 1, (size, size))
    return values + 2 * size * np.eye(size)


def in_second(comm):
    """Return which unknowns are in the second block: the last three of each rank."""
    return np.tile(np.arange(LOCAL) >= LOCAL - 3, comm.size)


def two_blocks(comm, modes=None):
    """Return two blocks that are solved for exactly, with near-null vectors of both."""
    second, none = in_second(comm), np.zeros((0, LOCAL))
    given = [none, none] if modes is None else modes
    return [
        Block(index_set(comm, chosen), part, FACTORS)
        for chosen, part in zip((~second, second), given, strict=True)
    ]


def applied(comm, solver, dense, b, constrained=None):
    """Return what a solver makes of b for a dense matrix."""
    free = np.zeros(LOCAL, dtype=bool) if constrained is None else constrained
    A, right = matrix(comm, dense, LOCAL), vector(comm, b)
    x = right.duplicate()
    x.set(7.0)
    with options(PREFIX, solver.defaults):
        solver.set_up(A, free)
    solver.solve(right, x)
    found = gathered(comm, x)
    for item in (A, right, x):
        item.destroy()
    return found


def test_a_direct_solver_solves(comm, dense):
    b = np.sin(np.arange(len(dense)))
    solver = DirectSolver(comm, PREFIX)
    for scale in (1.0, 3.0):
        found = applied(comm, solver, scale * dense, b)
        np.testing.assert_allclose(found, np.linalg.solve(scale * dense, b), rtol=1e-12)
    solver.destroy()


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
    every = np.ones(len(b), dtype=bool)
    solver = BlockSweep(comm, PREFIX, [Block(index_set(comm, every), np.zeros((0, 8)), FACTORS)])
    np.testing.assert_allclose(applied(comm, solver, dense, b), np.linalg.solve(dense, b))
    solver.destroy()


def test_a_block_is_solved_for_with_zeros_elsewhere(comm, dense):
    b, second = np.sin(1.0 + np.arange(len(dense))), in_second(comm)
    solver = BlockSolver(comm, PREFIX, two_blocks(comm)[1])
    assert solver.is_exact
    expected = np.zeros(len(b))
    expected[second] = np.linalg.solve(dense[np.ix_(second, second)], b[second])
    np.testing.assert_allclose(applied(comm, solver, dense, b), expected, rtol=1e-12)
    solver.destroy()


def near_null(nest, block):
    """Return the near-null vectors of a diagonal block on this rank, shape (vectors, local)."""
    vectors = nest.getNestSubMatrix(block, block).getNearNullSpace().getVecs()
    return np.array([v.array_r for v in vectors])


def test_near_null_vectors_follow_the_constraints(comm, dense):
    """They vanish where constrained, and are renewed once enough constraints have changed."""
    modes = [np.ones((1, LOCAL - 3)), np.ones((1, 3))]
    blocks = Blocks(comm, two_blocks(comm, modes))
    A = matrix(comm, dense, LOCAL)
    constrained = np.zeros(LOCAL, dtype=bool)
    constrained[0] = True
    nest = blocks.update(A, constrained)
    assert np.array_equal(near_null(nest, 0) != 0, [[False, True, True, True, True]])
    assert np.array_equal(near_null(nest, 1) != 0, [[True] * 3])

    few = constrained.copy()
    if comm.rank == 0:
        few[1:3] = True
    assert blocks.renew_modes(few) == []
    many = ~constrained & (np.arange(LOCAL) < LOCAL - 3)
    if comm.size * (LOCAL - 3) > MOST_CHANGED_IN_SWEEP:
        assert blocks.renew_modes(many) == [0]
        assert np.array_equal(near_null(nest, 0) != 0, [[True, False, False, False, False]])
    assert blocks.renew_modes(many) == []
    blocks.destroy()
    A.destroy()


def test_coarse_spaces_of_another_stiffness_are_outdated(comm, dense):
    """Of a block that stiffens or softens at some unknown, constrained ones left aside."""
    blocks, none = Blocks(comm, two_blocks(comm)), np.zeros(LOCAL, dtype=bool)
    constrained = none.copy()
    constrained[0] = True
    for factor, held, expected in (
        (1.0, none, []), (0.9 * MOST_STIFFENED, none, []), (1.1 * MOST_STIFFENED, none, [0]),
        (1.0, none, [0]), (1.1 * MOST_STIFFENED, constrained, []),
    ):  # fmt: skip
        changed = dense.copy()
        changed[0, 0] *= factor
        A = matrix(comm, changed, LOCAL)
        blocks.update(A, held if blocks.ready else none)
        assert blocks.renew_modes(held) == expected
        A.destroy()
    blocks.destroy()


def test_largest_factor_counts_growth_and_shrinking_alike(comm):
    then = np.array([2.0, -4.0, 0.0, 1.0])
    assert largest_factor(then, then, comm) == 1.0
    assert largest_factor(then * [1.0, 3.0, 1.0, 0.5], then, comm) == 3.0
    assert largest_factor(then * [1.0, 3.0, 1.0, 0.2], then, comm) == pytest.approx(5.0)
    only_here = then * [1.0, 7.0 if comm.rank == comm.size - 1 else 1.0, 1.0, 1.0]
    assert largest_factor(only_here, then, comm) == 7.0
    for changed in ([2.0, -4.0, 1e-9, 1.0], [2.0, 4.0, 0.0, 1.0]):
        assert largest_factor(np.array(changed), then, comm) == np.inf


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


def test_independent_vectors_become_orthonormal(comm):
    given = np.random.default_rng(3).uniform(-1, 1, (3, LOCAL * comm.size))
    dependent = given[0] - 2 * given[1]
    vectors = [vector(comm, v) for v in (given[0], given[1], dependent, given[2])]
    kept = np.array([gathered(comm, v) for v in orthonormal(vectors)])
    np.testing.assert_allclose(kept @ kept.T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(given, given @ kept.T @ kept, rtol=1e-12)
    for v in vectors:
        v.destroy()
