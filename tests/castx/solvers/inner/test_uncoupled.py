"""Free gaps give their bodies back: dense algebra of two bodies in which some rows are relative."""

from __future__ import annotations

from petsc4py import PETSc

import numpy as np
import pytest
from scipy import sparse

from castx.solvers.inner.sweep import BlockSweep
from castx.solvers.inner.uncoupled import Uncoupled
from tests.castx.solvers.distributed import gathered, matrix, vector
from tests.castx.solvers.inner.systems import LOCAL, PREFIX, applied, in_second, two_blocks

PAIRS = 2
"""Rows of the first block, the first ones of each rank, that are relative to the second."""


class Facing:
    """Two bodies with stiffness K, the first unknowns of each rank relative: u = P v, v = R u."""

    def __init__(self, comm):
        second, size = in_second(comm), LOCAL * comm.size
        rng = np.random.default_rng(3)
        self.K = np.zeros((size, size))
        for own in (~second, second):
            root = rng.uniform(-1, 1, (own.sum(), own.sum()))
            self.K[np.ix_(own, own)] = root @ root.T + np.eye(own.sum())
        self.gap = np.tile(np.arange(LOCAL) < PAIRS, comm.size)
        W = rng.uniform(0, 1, (size, size))
        W[~self.gap], W[:, ~second] = 0.0, 0.0
        self.coupling, self.P = -W, np.eye(size) + W
        self.A = self.P.T @ self.K @ self.P


def stored(comm, dense):
    """Return a matrix of which PETSc has the entries that are not zero, as that of pairs is."""
    own = sparse.csr_array(dense[comm.rank * LOCAL :][:LOCAL])
    pattern = own.indptr.astype(PETSc.IntType), own.indices.astype(PETSc.IntType)
    sizes = ((LOCAL, len(dense)),) * 2
    return PETSc.Mat().createAIJ(sizes, csr=(*pattern, own.data), comm=comm)


@pytest.fixture
def facing(comm):
    return Facing(comm)


def test_free_rows_belong_to_their_body_alone(comm, facing):
    """The others, closed pairs, stay relative; constrained unknowns stay where they are."""
    closed = np.tile(np.arange(LOCAL) == 0, comm.size)
    N = matrix(comm, facing.coupling, LOCAL)
    masked = np.where(closed[:, None] | closed, 0.0, facing.A) + np.diag(1.0 * closed)
    A, made = matrix(comm, masked, LOCAL), Uncoupled(N)
    found = made.set_up(A, closed[:LOCAL])
    T = np.where(closed[:, None] | closed, 0.0, facing.coupling) + np.eye(len(masked))
    x = np.sin(1.0 + np.arange(len(masked)))
    v, image = vector(comm, x), vector(comm, x)
    found.mult(v, image)
    np.testing.assert_allclose(gathered(comm, image), T.T @ masked @ T @ x, rtol=1e-12)
    np.testing.assert_allclose(gathered(comm, made.right_hand_side(v)), T.T @ x, rtol=1e-12)
    made.restore(v)
    np.testing.assert_allclose(gathered(comm, v), T @ x, rtol=1e-12)
    free = facing.gap & ~closed
    np.testing.assert_allclose((facing.P @ T)[free], np.eye(len(x))[free], atol=1e-14)
    for item in (made, N, A, v, image):
        item.destroy()


def test_one_sweep_solves_for_bodies_that_do_not_touch(comm, facing):
    """Without the uncoupling each body moves in the displacement of the other."""
    N, b = matrix(comm, facing.coupling, LOCAL), np.cos(np.arange(len(facing.A)))
    expected = np.linalg.solve(facing.A, b)
    for coupling, exact in ((N, True), (None, False)):
        solver = BlockSweep(comm, PREFIX, two_blocks(comm), coupling)
        found = applied(comm, solver, facing.A, b)
        assert np.allclose(found, expected, rtol=1e-9) == exact
        solver.destroy()
    N.destroy()


def test_no_entry_is_put_between_others(comm, facing):
    """Each one moves all that stand behind it: with 240,000 cells a set-up took minutes."""
    N = stored(comm, facing.coupling)
    A, made = matrix(comm, np.eye(len(facing.A)), LOCAL), Uncoupled(N)
    made.set_up(A, np.arange(LOCAL) == 1)
    assert made.T.getInfo()["mallocs"] == 0
    for item in (made, N, A):
        item.destroy()
