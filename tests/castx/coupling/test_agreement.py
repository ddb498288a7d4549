"""Resistances agree when their mean change is small and none of them changes by far more."""

from __future__ import annotations

import numpy as np
import pytest

from castx.coupling.agreement import LONE, disagreement

FOUND = np.array([1.0, 2.0, 4.0])


@pytest.mark.ranks
def test_the_mean_is_taken_over_the_areas(comm):
    """Of each rank the same three pairs, so that ranks change nothing."""
    tried, areas = FOUND * np.array([1.03, 1.0, 0.96]), np.array([1.0, 6.0, 2.0])
    expected = np.sqrt((1.0 * 0.03**2 + 2.0 * 0.04**2) / 9.0)
    assert disagreement(comm, FOUND, tried, areas) == pytest.approx(expected, rel=1e-12)


@pytest.mark.ranks
def test_the_mean_is_that_of_all_ranks(comm):
    """A change on the last rank alone, and a rank without pairs."""
    found = np.ones(1 if comm.rank == comm.size - 1 else 2 * comm.rank)
    tried = found - (0.01 if comm.rank == comm.size - 1 else 0.0)
    pairs = comm.allreduce(len(found))
    expected = pytest.approx(np.sqrt(0.01**2 / pairs), rel=1e-12)
    assert disagreement(comm, found, tried, np.ones(len(found))) == expected


@pytest.mark.ranks
def test_a_lone_pair_counts_on_whatever_rank(comm):
    """Beside a thousand that agree it counts for a hundredth of what all together would."""
    count, found = 100_000, np.ones(100_000)
    tried = found.copy()
    if comm.rank == comm.size - 1:
        tried[0] = 0.5
    alone = disagreement(comm, found, tried, np.ones(count))
    assert alone == pytest.approx(0.5 / LONE, rel=1e-12) and 0.5 / LONE > 0.5 / np.sqrt(count)


@pytest.mark.ranks
def test_pairs_that_conduct_nothing_or_perfectly_agree(comm):
    found = np.array([np.inf, 0.0, 1.0])
    assert disagreement(comm, found, found.copy(), np.ones(3)) == 0.0
    tried = np.array([1.0, 0.0, 1.0])
    assert disagreement(comm, found, tried, np.ones(3)) == np.inf
    nothing = np.zeros(0)
    assert disagreement(comm, nothing, nothing, nothing) == 0.0
