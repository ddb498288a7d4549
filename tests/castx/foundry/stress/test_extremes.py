"""Extreme values and their places, of entities that lie on any ranks."""

from __future__ import annotations

import numpy as np
import pytest

from castx.foundry.stress.extremes import largest, smallest

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
