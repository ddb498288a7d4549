"""Sums of a matrix and what it lacks against dense algebra, in one Mat while the pattern stays."""

from __future__ import annotations

from petsc4py import PETSc

import numpy as np
import pytest
from scipy.sparse import csr_array

from castx.solvers.inner.direct import DirectSolver
from castx.solvers.inner.whole_matrix import WholeMatrix
from tests.castx.solvers.distributed import gathered, vector
from tests.castx.solvers.inner.systems import LOCAL, PREFIX, applied


def chain(size):
    """Return a matrix of neighbours, which is not symmetric."""
    return 3 * np.eye(size) - np.eye(size, k=1) - 0.5 * np.eye(size, k=-1)


def next_neighbours(size):
    """Return what the chain lacks: its unknowns and those behind their neighbours."""
    return np.eye(size) + 0.3 * np.eye(size, k=2) + 0.2 * np.eye(size, k=-2)


def sparse(comm, dense):
    """Return a matrix with the entries that are not zero, each rank an equal part of its rows."""
    own = csr_array(dense[LOCAL * comm.rank : LOCAL * (comm.rank + 1)])
    csr = own.indptr.astype(np.int32), own.indices.astype(np.int32), own.data
    return PETSc.Mat().createAIJ(((LOCAL, len(dense)),) * 2, csr=csr, comm=comm)


def product(comm, A, x):
    right = vector(comm, x)
    found = right.duplicate()
    A.mult(right, found)
    values = gathered(comm, found)
    for item in (right, found):
        item.destroy()
    return values


@pytest.mark.ranks
def test_the_sum_lacks_nothing_but_rows_and_columns_of_constrained_unknowns(comm):
    size = LOCAL * comm.size
    constrained = np.zeros(size, dtype=bool)
    constrained[[2, size - 1]] = True
    own = slice(LOCAL * comm.rank, LOCAL * (comm.rank + 1))
    lacks, x = next_neighbours(size), np.cos(np.arange(size))
    whole = WholeMatrix(lambda: sparse(comm, lacks))
    free = np.outer(~constrained, ~constrained)
    for scale in (1.0, 2.0):
        A = sparse(comm, scale * chain(size))
        found = product(comm, whole.update(A, constrained[own]), x)
        np.testing.assert_allclose(found, (scale * chain(size) + free * lacks) @ x, rtol=1e-12)
        np.testing.assert_allclose(product(comm, A, x), scale * chain(size) @ x, rtol=1e-12)
        A.destroy()
    whole.destroy()


@pytest.mark.ranks
def test_one_mat_serves_as_long_as_the_pattern_stays(comm):
    """An entry more on one rank is another pattern on all of them."""
    size = LOCAL * comm.size
    whole, none = WholeMatrix(), np.zeros(LOCAL, dtype=bool)
    farther = chain(size)
    farther[0, 3] = 0.1
    handles = []
    for dense in (chain(size), 2 * chain(size), farther, farther + np.eye(size)):
        A = sparse(comm, dense)
        found = whole.update(A, none)
        handles.append(found.handle)
        np.testing.assert_allclose(product(comm, found, np.ones(size)), dense.sum(axis=1))
        A.destroy()
    assert handles[0] == handles[1] != handles[2] == handles[3]
    assert whole.matrix is not None
    whole.destroy()
    assert whole.matrix is None


@pytest.mark.ranks
def test_factors_are_those_of_the_sum(comm):
    size = LOCAL * comm.size
    b, lacks = np.sin(np.arange(size)), next_neighbours(size)
    solver = DirectSolver(comm, PREFIX, lacking=lambda: sparse(comm, lacks))
    for scale in (1.0, 3.0):
        found = applied(comm, solver, scale * chain(size), b)
        np.testing.assert_allclose(found, np.linalg.solve(scale * chain(size) + lacks, b))
    solver.destroy()
