"""Stiff nodes in a soft body: which they are, and that they are solved for exactly."""

from __future__ import annotations

import numpy as np
import pytest

from castx.solvers.inner.options import FACTORS
from castx.solvers.inner.stiff_part import LARGEST_SHARE, StiffPart
from tests.castx.solvers.distributed import gathered, index_set, matrix, options, vector

NODES, SIZE = 10, 2
LOCAL = NODES * SIZE
PREFIX = "castx_test_stiff_"


def soft_with(comm, stiff):
    """Return a symmetric matrix of nodes with a displacement and a pressure, some nodes stiff."""
    count = NODES * comm.size
    values = np.random.default_rng(5).uniform(-0.1, 0.1, (SIZE * count, SIZE * count))
    dense = values + values.T
    dense[range(0, SIZE * count, 2), range(0, SIZE * count, 2)] = np.where(stiff, 1e4, 2.0)
    dense[range(1, SIZE * count, 2), range(1, SIZE * count, 2)] = -1e6
    return dense


def set_up(comm, dense, constrained=None):
    """Return the stiff part of a matrix with one body, and the matrix."""
    rows = index_set(comm, np.ones(len(dense), dtype=bool))
    rows.setBlockSize(SIZE)
    part, A = StiffPart(comm, PREFIX, [rows]), matrix(comm, dense, LOCAL)
    with options(PREFIX, FACTORS):
        part.set_up(A, np.zeros(LOCAL, dtype=bool) if constrained is None else constrained)
    return part, A


@pytest.mark.ranks
def test_stiff_nodes_are_solved_for_with_all_their_unknowns(comm):
    stiff = np.tile(np.arange(NODES) < 2, comm.size)
    dense = soft_with(comm, stiff)
    part, A = set_up(comm, dense)
    assert part.exists
    b = np.cos(np.arange(len(dense)))
    right = vector(comm, b)
    x, rest = right.duplicate(), right.duplicate()
    x.set(7.0)
    part.solve(right, x, rest)
    chosen = np.repeat(stiff, SIZE)
    expected = np.zeros(len(b))
    expected[chosen] = np.linalg.solve(dense[np.ix_(chosen, chosen)], b[chosen])
    np.testing.assert_allclose(gathered(comm, x), expected, rtol=1e-10, atol=1e-14)
    np.testing.assert_allclose(gathered(comm, rest), b - dense @ expected, atol=1e-10)
    for item in (part, A, right, x, rest):
        item.destroy()


@pytest.mark.ranks
def test_ranks_without_stiff_nodes_take_part(comm):
    few = 2 if comm.size == 1 else NODES  # the last rank has no soft node
    stiff = np.arange(NODES * comm.size) >= NODES * comm.size - few
    dense = soft_with(comm, stiff)
    part, A = set_up(comm, dense)
    right = vector(comm, np.ones(len(dense)))
    x, rest = right.duplicate(), right.duplicate()
    part.solve(right, x, rest)
    np.testing.assert_array_equal(gathered(comm, x) != 0.0, np.repeat(stiff, SIZE))
    for item in (part, A, right, x, rest):
        item.destroy()


@pytest.mark.ranks
def test_constrained_unknowns_are_neither_stiff_nor_solved_for(comm):
    """The diagonal of a constrained row says nothing: its node is as stiff as its other rows."""
    stiff = np.tile(np.arange(NODES) < 2, comm.size)
    constrained = np.zeros(LOCAL, dtype=bool)
    constrained[0] = constrained[3] = True
    dense = soft_with(comm, stiff)
    part, A = set_up(comm, dense, constrained)
    right = vector(comm, np.ones(len(dense)))
    x, rest = right.duplicate(), right.duplicate()
    part.solve(right, x, rest)
    found = gathered(comm, x).reshape(comm.size, LOCAL)
    assert np.all(found[:, 2] != 0.0)
    assert not np.any(np.delete(found, 2, axis=1))
    for item in (part, A, right, x, rest):
        item.destroy()


@pytest.mark.ranks
@pytest.mark.parametrize("share", [0.0, LARGEST_SHARE + 0.1, 1.0])
def test_a_body_that_is_soft_or_mostly_stiff_needs_no_help(comm, share, monkeypatch):
    monkeypatch.setattr("castx.solvers.inner.stiff_part.CHEAP", 0)
    stiff = np.tile(np.arange(NODES) < share * NODES, comm.size)
    part, A = set_up(comm, soft_with(comm, stiff))
    assert not part.exists
    part.destroy()
    A.destroy()
