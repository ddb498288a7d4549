"""Bodies on rank 0: what one rank alone would have, in the same order."""

from mpi4py import MPI

import numpy as np
import pytest

from castx.results.files.vtu import Piece
from castx.results.gathered import GatheredBody, gathered_rows
from tests.castx.fakes import cylinder_mesh

pytestmark = pytest.mark.ranks


def corner_sets(whole):
    cells = whole.connectivity.reshape(whole.cells, -1)
    return np.sort(cells, axis=1)  # a cell may begin at another corner


@pytest.mark.parametrize("model, cells", [("axisymmetric", "quadrilaterals"), ("3d", "simplices")])
def test_a_body_is_the_same_on_any_number_of_ranks(comm, model, cells):
    spread = cylinder_mesh(comm, model, 6e-3, cells)
    alone = cylinder_mesh(MPI.COMM_SELF, model, 6e-3, cells)
    for name, body in spread.bodies.items():
        piece = Piece.of(body)
        found = GatheredBody.of(comm, body, piece)
        places = found.nodal(piece.points)
        middles = piece.points[piece.connectivity].reshape(piece.cells, -1, 3).mean(axis=1)
        middles = found.cellwise(middles if piece.cells else np.empty((0, 3)))
        if comm.rank > 0:
            assert found.whole.cells == 0 and len(places) == 0 and len(middles) == 0
            continue
        single = alone.bodies[name]
        expected = GatheredBody.of(MPI.COMM_SELF, single, Piece.of(single)).whole
        whole = found.whole
        np.testing.assert_array_equal(whole.nodes, expected.nodes)
        np.testing.assert_array_equal(whole.points, expected.points)
        np.testing.assert_array_equal(corner_sets(whole), corner_sets(expected))
        assert whole.kind == expected.kind
        np.testing.assert_array_equal(places, whole.points)
        centres = whole.points[whole.connectivity].reshape(whole.cells, -1, 3).mean(axis=1)
        np.testing.assert_allclose(middles, centres, atol=1e-15)


def test_rows_come_in_the_order_of_the_ranks(comm):
    mine = np.full((comm.rank, 2), float(comm.rank))  # none of the first rank
    found = gathered_rows(comm, mine)
    ranks = [rank for rank in range(comm.size) for _ in range(rank)]
    expected = np.array(ranks if comm.rank == 0 else [], dtype=float)
    np.testing.assert_array_equal(found, np.column_stack([expected, expected]))
