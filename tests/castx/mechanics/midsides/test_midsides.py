"""Mid-sides of a body: their ends, surfaces and numbers, on any number of ranks."""

from __future__ import annotations

import numpy as np
import pytest

from castx.mechanics.midsides.midsides import Midsides
from tests.castx.mechanics.lone_bodies import LENGTH, WIDTH, slab
from tests.elastic_bodies import everywhere
from tests.partitions import PARTITION, on_the_last, scattered, thinly_scattered

pytestmark = pytest.mark.ranks

CUT = pytest.mark.parametrize("cut", [None, scattered, thinly_scattered, on_the_last])


def made(comm, model, monkeypatch, cut):
    if cut is not None:
        monkeypatch.setattr(PARTITION, cut)
    body = slab(comm, model)
    return body, Midsides(body, model)


@CUT
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_every_edge_has_one_mid_side(comm, model, monkeypatch, cut):
    body, midsides = made(comm, model, monkeypatch, cut)
    owned = midsides.owned_midsides
    ends = np.sort(body.original_nodes[midsides.ends[:owned]], axis=1)
    numbers = everywhere(comm, midsides.numbering.numbers[:owned])
    corners = body.nodes.dofmap.list[: body.cell_numbering.owned]
    pairs = [corners[:, [a, b]] for a in range(corners.shape[1]) for b in range(a)]
    edges = np.sort(body.original_nodes[np.concatenate(pairs)], axis=1)
    expected = np.unique(everywhere(comm, edges), axis=0)
    np.testing.assert_array_equal(np.unique(everywhere(comm, ends), axis=0), expected)
    assert len(np.unique(numbers)) == len(numbers) == len(expected)
    assert midsides.owned == owned * midsides.block_size


@CUT
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_mid_sides_of_a_surface_lie_between_its_nodes(comm, model, monkeypatch, cut):
    """On the wall x = 0 of the slab all edges do that have both ends there."""
    body, midsides = made(comm, model, monkeypatch, cut)
    on = midsides.on_surface("wall")
    there = np.abs(body.points[midsides.ends][:, :, 0]).max(axis=1) < 1e-12
    np.testing.assert_array_equal(on, np.flatnonzero(there))


@pytest.mark.ranks
@CUT
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_mid_sides_are_found_by_the_ends_of_their_edges(comm, model, monkeypatch, cut):
    """On every rank those of all ranks, whatever the order of the ends."""
    body, midsides = made(comm, model, monkeypatch, cut)
    on = midsides.on_surface("wall")
    on = on[on < midsides.owned_midsides]
    nodes = body.nodes.dofmap.index_map.local_to_global(midsides.ends[on].ravel()).reshape(-1, 2)
    numbers = everywhere(comm, midsides.space.dofmap.index_map.local_to_global(on))
    ends = everywhere(comm, nodes)
    assert len(ends) > 1
    np.testing.assert_array_equal(midsides.at_edges("wall", ends[:, ::-1]), numbers)


def test_sums_are_those_of_all_ranks(comm):
    """Each owned cell gives one to its edges: edges on the outside have one cell, others two."""
    body = slab(comm)
    midsides = Midsides(body, "plane-strain")
    cells = midsides.cell_midsides[: midsides.owned_cells].ravel()
    found = midsides.sum(np.bincount(cells, minlength=midsides.count).astype(float))
    middles = body.points[midsides.ends].mean(axis=1)
    limits = np.array([LENGTH, WIDTH])
    outside = ((middles < 1e-9) | (middles > limits - 1e-9)).any(axis=1)
    np.testing.assert_array_equal(found, np.where(outside, 1.0, 2.0))
