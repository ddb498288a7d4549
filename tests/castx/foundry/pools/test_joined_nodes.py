"""Regions of nodes on structured meshes, whatever ranks hold their parts."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain.mesh import build_mesh
from castx.foundry.pools.joined_nodes import NodeRegions
from tests.castx.fakes import cylinder_mesh

SIZE = 1e-3


def box(comm, cells):
    sizes = {"length": 0.012, "width": 0.004, "size": SIZE, "cells": cells}
    description = {"model": "plane-strain", "generator": "slab", **sizes}
    return build_mesh(Geometry.model_validate(description), ["casting"], comm).bodies["casting"]


@pytest.fixture(scope="module", params=["simplices", "quadrilaterals"])
def slab(request):
    return box(MPI.COMM_WORLD, request.param)


def found(body, chosen):
    """Return the regions of nodes by their rounded places on all ranks."""
    count, region = NodeRegions(body).find(chosen)
    places = [tuple(place) for place in np.round(body.points / SIZE).astype(int).tolist()]
    every: dict[tuple[int, ...], int] = {}
    for of_rank in body.mesh.comm.allgather(dict(zip(places, region.tolist(), strict=True))):
        assert all(every.get(place, number) == number for place, number in of_rank.items())
        every |= of_rank
    return count, every


def test_edges_join_and_a_row_between_parts(slab):
    x = np.round(slab.points[:, 0] / SIZE)
    count, region = found(slab, (x <= 4) | (x >= 6))
    assert count == 2
    sides = [{number for place, number in region.items() if part(place[0])}
             for part in (lambda x: x <= 4, lambda x: x == 5, lambda x: x >= 6)]  # fmt: skip
    assert sides[1] == {-1} and sides[0] | sides[2] == {0, 1}
    assert len(sides[0]) == len(sides[2]) == 1
    assert found(slab, x >= 0)[0] == 1


@pytest.mark.ranks
def test_single_nodes_are_regions_and_nothing_is_none(slab):
    x, y = np.round(slab.points / SIZE).T
    single = ((x == 2) & (y == 2)) | ((x == 8) & (y == 2))
    count, region = found(slab, single)
    assert count == 2
    assert sorted(number for number in region.values() if number >= 0) == [0, 1]
    assert found(slab, x < 0) == (0, dict.fromkeys(region, -1))


def test_corners_of_a_square_are_not_joined_through_it():
    """On quadrilaterals the diagonal is no edge; cells that share the node would join them."""
    body = box(MPI.COMM_WORLD, "quadrilaterals")
    x, y = np.round(body.points / SIZE).T
    assert found(body, ((x == 4) & (y == 2)) | ((x == 5) & (y == 3)))[0] == 2
    assert found(body, ((x == 4) & (y == 2)) | ((x == 5) & (y == 2)))[0] == 1


@pytest.mark.ranks
def test_numbers_are_those_of_one_rank(comm):
    """Columns with gaps between them, in space: the same numbers as without ranks."""
    numbers = []
    for ranks in (MPI.COMM_SELF, comm):
        body = cylinder_mesh(ranks, "3d", 8e-3).bodies["casting"]
        z = body.points[:, 2]
        chosen = (z < 0.2 * 0.04) | (np.abs(z - 0.02) < 0.15 * 0.02) | (z > 0.8 * 0.04)
        count, region = NodeRegions(body).find(chosen)
        owned = body.node_numbering.owned
        pairs = zip(body.original_nodes[:owned].tolist(), region[:owned].tolist(), strict=True)
        every = dict(pair for part in ranks.allgather(list(pairs)) for pair in part)
        numbers.append((count, every))
    assert numbers[0] == numbers[1]
    assert numbers[0][0] >= 2


def test_neighbours_are_one_edge_away(comm):
    body = box(comm, "quadrilaterals")
    x = np.round(body.points[:, 0] / SIZE)
    near = NodeRegions(body).neighbours_of(np.column_stack([x == 5, x == 0]))
    assert near[:, 0].tolist() == (np.abs(x - 5) <= 1).tolist()
    assert near[:, 1].tolist() == (x <= 1).tolist()


@pytest.mark.serial
def test_a_node_is_no_neighbour_of_itself(comm):
    body = box(comm, "quadrilaterals")
    away = np.round(body.points / SIZE) - [5, 2]
    near = NodeRegions(body).neighbours_of((away == 0).all(axis=1)[:, None])
    assert near[:, 0].tolist() == (np.abs(away).sum(axis=1) == 1).tolist()


@pytest.mark.ranks
def test_nodes_are_joined_by_chosen_ones_alone(comm):
    body = box(comm, "simplices")
    x = np.round(body.points[:, 0] / SIZE)
    regions = NodeRegions(body)
    assert regions.join(x == 1, x == 9, x < 20)
    assert not regions.join(x == 1, x == 9, x != 5)
    assert not regions.join(x == 1, x == 9, x < 9)
