"""What full pockets add to the Jacobian, against dense matrices of rank one."""

from __future__ import annotations

import numpy as np
import pytest

from castx.mechanics.liquid.stiffness import PocketStiffness, pockets_of_nodes
from tests.castx.mechanics.lone_bodies import LENGTH, slab
from tests.elastic_bodies import everywhere

SIZE = 3


class Nodes:
    """Nodes of this rank, some of them in pockets, with rows and columns at random."""

    def __init__(self, comm, pocket):
        self.comm, self.pocket = comm, np.array(pocket, dtype=np.int32)
        random = np.random.default_rng(11 + comm.rank)
        self.rows, self.columns, self.x = random.standard_normal((3, SIZE * len(pocket)))
        self.made = PocketStiffness(comm, SIZE)
        self.made.begin(self.pocket, self.rows, self.columns)

    def product(self):
        y = np.full(len(self.x), 5.0)
        self.made.add_product(self.x, y)
        return y - 5.0

    def dense(self, stiffness):
        """Return Σ_k c_k s_k b_kᵀ x, by whole vectors that are zero outside the pocket k."""
        pocket, x, b, c = (
            everywhere(self.comm, each)
            for each in (np.repeat(self.pocket, SIZE), self.x, self.rows, self.columns)
        )
        A = np.zeros((len(x), len(x)))
        for k, s in enumerate(stiffness):
            A += s * np.outer(np.where(pocket == k, c, 0.0), np.where(pocket == k, b, 0.0))
        first = int(self.comm.exscan(len(self.x)) or 0)
        return (A @ x)[first : first + len(self.x)]


@pytest.fixture(params=["spread", "one rank", "few nodes"])
def nodes(comm, request):
    """Return nodes of two pockets that all ranks share, or of which some ranks have none."""
    pocket = [-1, 1, 0, -1, 1, 0, 0, -1]
    if request.param == "one rank":
        pocket = pocket if comm.rank == comm.size - 1 else [-1, -1]
    elif request.param == "few nodes":
        pocket = [0, 1, -1, -1, -1] if comm.rank == 0 else []
    return Nodes(comm, pocket)


@pytest.mark.ranks
@pytest.mark.parametrize("stiffness", [(3.0, 0.7), (3.0, 0.0), (0.0, 0.7)])
def test_the_product_is_that_of_the_dense_matrix(nodes, stiffness):
    """A pocket that has pores has no stiffness, and nodes in no pocket have no rows."""
    nodes.made.stiffness = np.array(stiffness)
    assert nodes.made.exists
    found, expected = nodes.product(), nodes.dense(stiffness)
    np.testing.assert_allclose(found, expected, atol=1e-13)
    outside = np.isin(nodes.pocket, [-1, *np.flatnonzero(np.array(stiffness) == 0)])
    assert not found.reshape(-1, SIZE)[outside].any()
    assert nodes.comm.allreduce(int(np.count_nonzero(found))) > 0


def test_porous_pockets_have_none(nodes):
    nodes.made.stiffness = np.zeros(2)
    assert not nodes.made.exists and not nodes.product().any()


def test_without_pockets_there_is_nothing_to_add(comm):
    made, y = PocketStiffness(comm, SIZE), np.ones(6)
    made.add_product(np.ones(6), y)
    assert not made.exists and (y == 1.0).all()


@pytest.mark.ranks
def test_what_a_next_step_gives_takes_the_place_of_the_last(nodes):
    nodes.made.stiffness = np.array([3.0, 0.7])
    before = nodes.product()
    nodes.rows, nodes.columns = 2 * nodes.rows, 3 * nodes.columns
    nodes.made.begin(nodes.pocket, nodes.rows, nodes.columns)
    np.testing.assert_allclose(nodes.product(), 6 * before, rtol=1e-12, atol=1e-13)


@pytest.mark.ranks
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_nodes_are_in_the_pocket_of_a_cell_of_any_rank(comm, cells):
    """Two pockets of one column of cells at the ends of a slab."""
    body = slab(comm, cells=cells)
    x = body.points[:, 0] / LENGTH
    centre = x[body.nodes.dofmap.list].mean(axis=1)
    found = pockets_of_nodes(body, np.select([centre < 0.25, centre > 0.75], [1, 0], -1))
    owned = body.nodes.dofmap.index_map.size_local
    expected = np.select([x < 0.26, x > 0.74], [1, 0], -1)[:owned]
    np.testing.assert_array_equal(found, expected)
    assert found.dtype == np.int32 and comm.allreduce(len(np.flatnonzero(found < 0))) > 0
