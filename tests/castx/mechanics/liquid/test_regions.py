"""Regions of cells on a slab, whatever ranks hold its parts."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from castx.mechanics.liquid.regions import CellRegions
from tests.elastic_bodies import generated


@pytest.fixture(scope="module")
def slab():
    sizes = {"length": 0.04, "width": 0.02, "size": 0.0025}
    return generated(MPI.COMM_WORLD, "plane-strain", "slab", ["casting"], **sizes).bodies["casting"]


def midpoints(body):
    return body.points[body.nodes.dofmap.list].mean(axis=1).T


def numbers(body, region, part):
    """Return the numbers that the cells of a part have on all ranks."""
    found = body.mesh.comm.allgather(set(region[part].tolist()))
    return set().union(*found)


def test_parts_that_do_not_touch_have_their_own_numbers_everywhere(slab):
    x, y = midpoints(slab)
    left, right, band = x < 0.01, x > 0.03, (x > 0.015) & (x < 0.025) & (y < 0.01)
    count, region = CellRegions(slab).find(left | right | band)
    assert count == 3
    every = [numbers(slab, region, part) for part in (left, right, band)]
    assert [len(found) for found in every] == [1, 1, 1]
    assert set().union(*every) == {0, 1, 2}
    assert numbers(slab, region, ~(left | right | band)) <= {-1}


@pytest.mark.ranks
def test_a_band_joins_them(slab):
    x, y = midpoints(slab)
    ends, band = (x < 0.01) | (x > 0.03), y < 0.005
    count, region = CellRegions(slab).find(ends | band)
    assert count == 1
    assert np.array_equal(region == 0, ends | band)


def test_one_common_node_joins(slab):
    """Two quadrants of a square touch in its middle."""
    x, y = midpoints(slab)
    lower, upper = (x < 0.02) & (y < 0.01), (x > 0.02) & (y > 0.01)
    assert CellRegions(slab).find(lower | upper)[0] == 1
    apart = upper & (x > 0.0226)
    assert CellRegions(slab).find(lower | apart)[0] == 2


@pytest.mark.ranks
def test_nothing_chosen_has_no_region(slab):
    count, region = CellRegions(slab).find(np.zeros(len(midpoints(slab)[0]), dtype=bool))
    assert count == 0
    assert np.all(region == -1)


@pytest.mark.ranks
def test_halves_that_meet_at_nodes_that_do_not_join_are_two_regions(slab):
    """All cells are chosen, and touch; the column of nodes in the middle parts them."""
    x, _ = midpoints(slab)
    left, every = x < 0.02, np.ones(len(x), dtype=bool)
    at, height = slab.points[:, 0], slab.points[:, 1]
    middle = np.abs(at - 0.02) < 1e-9
    assert slab.mesh.comm.allreduce(int(middle.sum())) > 0
    regions = CellRegions(slab)
    count, region = regions.find(every, ~middle)
    assert count == 2
    halves = [numbers(slab, region, part) for part in (left, ~left)]
    assert sorted(halves, key=min) == [{0}, {1}]
    for joining in (~middle | (height < 1e-9), None):
        count, region = regions.find(every, joining)
        assert count == 1 and np.all(region == 0)
