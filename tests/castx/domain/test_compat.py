"""What differs between versions of DOLFINx: making meshes, destinations of cells, submeshes."""

import numpy as np
import pytest

from castx.domain import compat


def columns(comm, kind):
    """Return a row of squares, as points and cells on rank 0 and nothing elsewhere."""
    count = 2 * comm.size
    x = np.arange(count + 1.0)
    points = np.stack([np.tile(x, 2), np.repeat([0.0, 1.0], count + 1)], axis=1)
    left = np.arange(count)
    below, above = left, left + count + 1
    if kind == "quadrilateral":
        cells = np.stack([below, below + 1, above, above + 1], axis=1)
    else:
        cells = np.concatenate(
            [
                np.stack([below, below + 1, above + 1], axis=1),
                np.stack([below, above + 1, above], axis=1),
            ]
        )
    if comm.rank > 0:
        points, cells = points[:0], cells[:0]
    return points, cells.astype(np.int64)


@pytest.fixture(params=["triangle", "quadrilateral"])
def row(request, comm):
    """A row of squares from x = 0, two for each rank, and the rank that each cell was given to."""
    points, cells = columns(comm, request.param)
    middle = (cells % (2 * comm.size + 1)).min(axis=1)
    rank = (middle // 2).astype(np.int32)

    def partitioner(*_):
        return compat.destinations(rank, np.arange(len(rank) + 1, dtype=np.int32))

    return compat.create_linear_mesh(comm, points, cells, request.param, partitioner)


def test_cells_go_where_they_are_sent(row, comm):
    per_rank = 2 if row.topology.cell_name() == "quadrilateral" else 4
    assert row.topology.index_map(2).size_local == per_rank
    assert row.geometry.dim == 2
    corners = row.geometry.x[row.geometry.dofmap[:per_rank]]
    assert (np.floor(corners[:, :, 0].min(axis=1) / 2) == comm.rank).all()


def test_a_submesh_knows_its_parents(row, comm):
    dim = row.topology.dim
    row.topology.create_connectivity(dim, 0)
    middles = row.geometry.x[row.geometry.dofmap].mean(axis=1)
    chosen = np.flatnonzero(middles[:, 0] > comm.size).astype(np.int32)
    part, cells, vertices = compat.create_submesh(row, chosen)
    assert np.array_equal(np.sort(cells), chosen)
    found = part.geometry.x[part.geometry.dofmap].mean(axis=1)
    np.testing.assert_allclose(found, middles[cells], atol=1e-14)
    own = part.topology.connectivity(dim, 0).array
    parents = row.topology.connectivity(dim, 0)
    for cell, parent in enumerate(cells):
        first = cell * len(parents.links(parent))
        corners = own[first : first + len(parents.links(parent))]
        assert set(vertices[corners]) == set(parents.links(parent))
    whole = comm.allreduce(part.topology.index_map(dim).size_local)
    per_square = 1 if row.topology.cell_name() == "quadrilateral" else 2
    assert whole == comm.size * per_square
