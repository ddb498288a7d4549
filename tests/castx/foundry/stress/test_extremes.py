"""Extreme values and their places, of entities that lie on any ranks."""

from __future__ import annotations

import numpy as np
import pytest

from castx.foundry.stress.extremes import largest, quantile, smallest

VALUES = np.array([3.0, -7.0, 9.0, 9.0 * (1.0 - 1e-12), 2.0, -7.0])
NUMBERS = np.array([5, 4, 3, 2, 1, 0])
POINTS = np.column_stack([0.1 * NUMBERS, -0.1 * NUMBERS])


@pytest.mark.ranks
def test_the_first_entity_of_those_with_the_extreme_value_is_its_place(comm):
    mine = np.arange(len(VALUES)) % comm.size == comm.rank
    given = comm, VALUES[mine], NUMBERS[mine], POINTS[mine]
    assert largest(*given) == {"value": 9.0, "place": pytest.approx([0.2, -0.2])}
    assert smallest(*given) == {"value": -7.0, "place": pytest.approx([0.0, 0.0])}


@pytest.mark.ranks
def test_a_rank_without_entities_takes_part(comm):
    count = len(VALUES) if comm.rank == comm.size - 1 else 0
    found = largest(comm, VALUES[:count], NUMBERS[:count], POINTS[:count])
    assert found["value"] == 9.0 and found["place"] == pytest.approx([0.2, -0.2])


@pytest.mark.ranks
def test_a_share_of_the_volume_stays_below_a_quantile(comm):
    """Of volumes 1, 3, 4 and 2 with the values 1, 2, 3 and 9, 80 % do not exceed 3."""
    values, volumes = np.array([9.0, 1.0, 3.0, 2.0]), np.array([2.0, 1.0, 4.0, 3.0])
    mine = np.arange(4) % comm.size == comm.rank
    for share, value in ((0.05, 1.0), (0.39, 2.0), (0.41, 3.0), (0.79, 3.0), (0.81, 9.0)):
        found = quantile(comm, values[mine], volumes[mine], share)
        assert found == pytest.approx(value, rel=1e-9)
