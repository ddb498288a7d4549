"""Factors by which numbers change."""

from __future__ import annotations

import numpy as np
import pytest

from castx.solvers.inner.entries import diagonal, is_symmetric, largest_factor
from tests.castx.solvers.distributed import matrix
from tests.castx.solvers.inner.systems import LOCAL


@pytest.mark.ranks
def test_largest_factor_counts_growth_and_shrinking_alike(comm):
    then = np.array([2.0, -4.0, 0.0, 1.0])
    assert largest_factor(then, then, comm) == 1.0
    assert largest_factor(then * [1.0, 3.0, 1.0, 0.5], then, comm) == 3.0
    assert largest_factor(then * [1.0, 3.0, 1.0, 0.2], then, comm) == pytest.approx(5.0)
    only_here = then * [1.0, 7.0 if comm.rank == comm.size - 1 else 1.0, 1.0, 1.0]
    assert largest_factor(only_here, then, comm) == 7.0
    for changed in ([2.0, -4.0, 1e-9, 1.0], [2.0, 4.0, 0.0, 1.0]):
        assert largest_factor(np.array(changed), then, comm) == np.inf


@pytest.mark.ranks
def test_a_rank_without_entries_knows_the_factor_of_others(comm):
    then = np.ones(1 if comm.rank == comm.size - 1 else 0)
    assert largest_factor(3.0 * then, then, comm) == 3.0


def test_the_diagonal_is_that_of_the_owned_rows(comm, dense):
    A = matrix(comm, dense, LOCAL)
    own = slice(*A.getOwnershipRange())
    np.testing.assert_array_equal(diagonal(A), np.diagonal(dense)[own])
    A.destroy()


@pytest.mark.ranks
def test_a_symmetric_matrix_is_told_from_one_that_differs_in_a_soft_entry(comm, dense):
    stiffness = np.where(np.arange(len(dense)) % 3 == 0, 1e5, 1.0)
    symmetric = (dense + dense.T) * stiffness * stiffness[:, None]
    changed = symmetric.copy()
    changed[1, -1] *= 1.0 + 1e-4
    rounded = symmetric * (1.0 + 1e-14 * np.random.default_rng(3).uniform(-1, 1, dense.shape))
    for values, same in ((symmetric, True), (rounded, True), (changed, False), (dense, False)):
        A = matrix(comm, values, LOCAL)
        assert is_symmetric(A) is same
        A.destroy()
