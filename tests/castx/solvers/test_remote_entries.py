"""Entries of a vector that other ranks own, against the whole vector."""

from __future__ import annotations

import numpy as np
import pytest

from castx.solvers.remote_entries import RemoteEntries
from tests.castx.solvers.distributed import gathered, vector

LOCAL = 4


@pytest.mark.ranks
def test_entries_of_any_rank_are_read(comm):
    values = np.arange(LOCAL * comm.size) ** 1.5
    numbers = np.array([len(values) - 1, 0, 2, 0], dtype=np.int32)
    made = vector(comm, values)
    entries = RemoteEntries(made, numbers)
    np.testing.assert_array_equal(entries.get(made), values[numbers])
    made.scale(2.0)
    np.testing.assert_array_equal(entries.get(made), 2 * values[numbers])
    entries.destroy()


def test_entries_are_written_where_their_owner_is(comm):
    """Each rank writes into the part of the next one; all other entries stay."""
    size = LOCAL * comm.size
    made = vector(comm, np.full(size, -1.0))
    numbers = (np.array([3, 1]) + LOCAL * ((comm.rank + 1) % comm.size)).astype(np.int32)
    entries = RemoteEntries(made, numbers)
    entries.put(10.0 * numbers, made)
    expected = np.full((comm.size, LOCAL), -1.0)
    expected[:, [1, 3]] = 10.0 * np.arange(size).reshape(-1, LOCAL)[:, [1, 3]]
    np.testing.assert_array_equal(gathered(comm, made), expected.ravel())
    entries.destroy()


@pytest.mark.ranks
def test_what_all_ranks_add_adds_up(comm):
    size = LOCAL * comm.size
    made = vector(comm, np.ones(size))
    entries = RemoteEntries(made, np.array([size - 1, 0, 0], dtype=np.int32))
    entries.add(np.array([5.0, 2.0, 1.0]) * (1 + comm.rank), made)
    expected = np.ones(size)
    expected[[0, -1]] += np.array([3.0, 5.0]) * sum(range(1, comm.size + 1))
    np.testing.assert_allclose(gathered(comm, made), expected, rtol=1e-14)
    entries.destroy()
