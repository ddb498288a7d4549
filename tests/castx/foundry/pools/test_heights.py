"""Highest places of pools: those that hold what a pool lacks, the same on any ranks."""

from __future__ import annotations

import numpy as np
import pytest

from castx.foundry.pools.heights import Heights, Places
from tests.castx.fakes import cylinder_mesh
from tests.partitions import PARTITION, on_the_last

SIZE = 4e-3


@pytest.mark.ranks
def test_places_are_rows_of_nodes_from_the_top(comm):
    """The two uppermost of eleven rows hold what the pool lacks; one more is there at least."""
    body = cylinder_mesh(comm, size=SIZE, cells="quadrilaterals").bodies["casting"]
    heights = Heights(body, (0.0, 1.0))
    owned = body.node_numbering.owned
    pool = np.zeros(owned, dtype=np.int32)
    in_row = comm.allreduce(int((body.points[:owned, 1] > 0.0399).sum()))
    liquid, freezing = np.ones(owned), np.full(owned, 0.25)
    rows = heights.highest(pool, liquid, freezing, np.array([0.75 * in_row * 1.5]))
    places = Places.of(rows, 0)
    assert len(places.keys) >= 3
    np.testing.assert_allclose(places.heights[:3], [0.04, 0.036, 0.032], rtol=1e-8)
    np.testing.assert_allclose(places.liquid[:2], in_row)
    np.testing.assert_allclose(places.freezing[:2], 0.25 * in_row)
    nodes, place = places.among(np.arange(owned), heights.keys[:owned])
    # A rank without the uppermost rows keeps lower ones, and others need not have them.
    np.testing.assert_allclose(places.heights[place], body.points[nodes, 1], rtol=1e-8)
    uppermost = np.flatnonzero(body.points[:owned, 1] > 0.0319)
    assert nodes[place < 3].tolist() == uppermost.tolist()


@pytest.mark.ranks
def test_ranks_without_nodes_know_the_places_of_others(comm, monkeypatch):
    monkeypatch.setattr(PARTITION, on_the_last)
    body = cylinder_mesh(comm, size=SIZE, cells="quadrilaterals").bodies["casting"]
    owned = body.node_numbering.owned
    heights = Heights(body, (0.0, 1.0))
    pool, liquid = np.zeros(owned, dtype=np.int32), np.ones(owned)
    places = Places.of(heights.highest(pool, liquid, 0.25 * liquid, np.array([1.0])), 0)
    np.testing.assert_allclose(places.heights[:2], [0.04, 0.036], rtol=1e-8)


@pytest.mark.serial
def test_a_place_reaches_down_to_the_middle_of_the_next_one():
    places = Places(np.array([9, 5, 1]), np.array([9.0, 5.0, 1.0]), np.ones(3), np.zeros(3))
    for left, level in (
        ([1.0, 1.0, 1.0], 9.0), ([0.5, 1.0, 1.0], 8.0), ([0.0, 1.0, 1.0], 7.0),
        ([0.0, 0.25, 1.0], 4.0), ([0.0, 0.0, 0.0], 1.0),
    ):  # fmt: skip
        assert places.level(np.array(left), 9.0) == pytest.approx(level)
