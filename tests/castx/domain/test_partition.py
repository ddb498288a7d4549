"""Distribution of cells: balanced bodies, unparted neighbours across interfaces, right ghosts."""

import numpy as np
import pytest

from castx.domain.cell_kinds import TRIANGLE
from castx.domain.faces import neighbours
from castx.domain.partition import destinations, partition
from castx.meshes.structured import grid

pytestmark = pytest.mark.serial


def two_bodies(columns=24, rows=20):
    """A square whose left third is body 1."""
    mesh = grid(
        np.linspace(0, 1, columns + 1),
        np.linspace(0, 1, rows + 1),
        lambda m: (m[:, 0] < 1 / 3).astype(int),
    )
    across = neighbours(mesh.cells, TRIANGLE.faces, "test")
    return mesh.points[mesh.cells].mean(axis=1), mesh.regions, across


@pytest.mark.parametrize("parts", [2, 3, 4, 7])
def test_every_body_is_divided_evenly(parts):
    midpoints, bodies, across = two_bodies()
    rank = partition(midpoints, bodies, across, parts)
    assert set(rank) == set(range(parts))
    for body in (0, 1):
        share = np.bincount(rank[bodies == body], minlength=parts) / (bodies == body).sum()
        assert share.max() < 1.3 / parts


@pytest.mark.parametrize("parts", [2, 3, 4, 7])
def test_cells_that_face_each_other_stay_together(parts):
    midpoints, bodies, across = two_bodies()
    rank = partition(midpoints, bodies, across, parts)
    cell, corner = np.nonzero((across >= 0) & (bodies[across] != bodies[:, None]))
    assert len(cell) == 2 * 20
    assert np.array_equal(rank[cell], rank[across[cell, corner]])


def test_the_shorter_cut_is_taken():
    mesh = grid(np.linspace(0, 10, 101), np.linspace(0, 1, 11), lambda m: np.zeros(len(m), int))
    across = neighbours(mesh.cells, TRIANGLE.faces, "test")
    rank = partition(mesh.points[mesh.cells].mean(axis=1), mesh.regions, across, 2)
    cell, corner = np.nonzero(across >= 0)
    assert np.count_nonzero(rank[cell] != rank[across[cell, corner]]) // 2 <= 10


def test_one_rank_gets_everything():
    midpoints, bodies, across = two_bodies()
    rank = partition(midpoints, bodies, across, 1)
    values, offsets = destinations(rank, across)
    assert not rank.any() and not values.any()
    assert np.array_equal(offsets, np.arange(len(rank) + 1))


def test_more_ranks_than_cells():
    midpoints, bodies, across = two_bodies(columns=3, rows=1)
    rank = partition(midpoints, bodies, across, 20)
    assert rank.min() >= 0 and rank.max() < 20


def test_cells_go_to_their_owner_first_and_to_the_owners_of_their_neighbours():
    midpoints, bodies, across = two_bodies()
    rank = partition(midpoints, bodies, across, 3)
    values, offsets = destinations(rank, across)
    for cell in range(len(rank)):
        holders = values[offsets[cell] : offsets[cell + 1]]
        beside = set(rank[across[cell][across[cell] >= 0]]) - {rank[cell]}
        assert holders[0] == rank[cell]
        assert set(holders[1:]) == beside and len(holders) == 1 + len(beside)
