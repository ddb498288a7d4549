"""Blocks of a matrix: which of them are copied, and their near-null vectors."""

from __future__ import annotations

import numpy as np
import pytest

from castx.solvers.inner.nest import (
    MOST_CHANGED_IN_SWEEP,
    MOST_STIFFENED,
    RESET_UP,
    Block,
    Blocks,
    orthonormal,
)
from castx.solvers.inner.options import MULTIGRID
from tests.castx.solvers.distributed import gathered, index_set, matrix, vector
from tests.castx.solvers.inner.systems import LOCAL, in_second, two_blocks


def near_null(nest, block):
    """Return the near-null vectors of a diagonal block on this rank, shape (vectors, local)."""
    vectors = nest.getNestSubMatrix(block, block).getNearNullSpace().getVecs()
    return np.array([v.array_r for v in vectors])


@pytest.mark.ranks
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


@pytest.mark.ranks
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


def by_multigrid(comm):
    """Return two blocks that are not solved for exactly."""
    second, none = in_second(comm), np.zeros((0, LOCAL))
    return [Block(index_set(comm, own), none, MULTIGRID) for own in (~second, second)]


def renewed(comm, blocks, dense, constrained, anew=False):
    """Return which diagonal blocks PETSc takes for new ones after an update, and the nest."""
    nest, before = blocks.nest, [-1, -1]
    if nest is not None:
        before = [nest.getNestSubMatrix(b, b).stateGet() for b in range(2)]
    A = matrix(comm, dense, LOCAL)
    nest = blocks.update(A, constrained, anew)
    A.destroy()
    after = [nest.getNestSubMatrix(b, b).stateGet() for b in range(2)]
    return [now != then for now, then in zip(after, before, strict=True)], nest


@pytest.mark.ranks
@pytest.mark.parametrize(
    ("factor", "held", "expected"),
    [
        (0.99 * RESET_UP, 0, [False, True]),
        (1.01 * RESET_UP, 0, [True, True]),
        (1.0, 1, [False, True]),
        (1.0, MOST_CHANGED_IN_SWEEP + 1, [True, True]),
    ],
)
def test_a_multigrid_whose_block_hardly_changes_stays(comm, dense, factor, held, expected):
    """The second block becomes twice as stiff, the first a little, or some of it is constrained."""
    blocks, constrained = Blocks(comm, by_multigrid(comm)), np.zeros(LOCAL, dtype=bool)
    assert renewed(comm, blocks, dense, constrained)[0] == [True, True]
    changed, second = dense + np.eye(len(dense), k=1), in_second(comm)
    changed[0, 0] *= factor
    changed[second, second] *= 2.0
    if comm.rank == comm.size - 1:
        constrained[:held] = True
    # The diagonal of what is constrained says nothing.
    own = slice(len(dense) - LOCAL, len(dense) - LOCAL + held)
    changed[own, own] *= 7.0
    assert renewed(comm, blocks, changed, constrained)[0] == expected
    assert renewed(comm, blocks, changed, constrained)[0] == [False, False]
    assert renewed(comm, blocks, changed, constrained, anew=True)[0] == [True, True]
    blocks.destroy()


@pytest.mark.ranks
def test_what_couples_blocks_is_always_copied(comm, dense):
    blocks, free = Blocks(comm, by_multigrid(comm)), np.zeros(LOCAL, dtype=bool)
    renewed(comm, blocks, dense, free)
    changed, second = dense.copy(), in_second(comm)
    changed[np.ix_(~second, second)] *= 3.0
    changed[second, second] *= 2.0
    (first, _), nest = renewed(comm, blocks, changed, free)
    assert not first
    ones = nest.getNestSubMatrix(0, 1).createVecRight()
    sums = nest.getNestSubMatrix(0, 1).createVecLeft()
    ones.set(1.0)
    nest.getNestSubMatrix(0, 1).mult(ones, sums)
    expected = changed[np.ix_(~second, second)].sum(axis=1)
    np.testing.assert_allclose(gathered(comm, sums), expected, rtol=1e-12)
    for item in (ones, sums, blocks):
        item.destroy()


@pytest.mark.ranks
def test_independent_vectors_become_orthonormal(comm):
    given = np.random.default_rng(3).uniform(-1, 1, (3, LOCAL * comm.size))
    dependent = given[0] - 2 * given[1]
    vectors = [vector(comm, v) for v in (given[0], given[1], dependent, given[2])]
    kept = np.array([gathered(comm, v) for v in orthonormal(vectors)])
    np.testing.assert_allclose(kept @ kept.T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(given, given @ kept.T @ kept, rtol=1e-12)
    for v in vectors:
        v.destroy()
