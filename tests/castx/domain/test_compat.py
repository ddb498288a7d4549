"""What differs between versions: making meshes, destinations of cells, submeshes, elements."""

import ctypes
import logging
import os
import signal

from mpi4py import MPI
from petsc4py import PETSc

import basix.ufl
import numpy as np
import pytest
from dolfinx import fem, mesh

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


@pytest.mark.ranks
def test_cells_go_where_they_are_sent(row, comm):
    per_rank = 2 if row.topology.cell_name() == "quadrilateral" else 4
    assert row.topology.index_map(2).size_local == per_rank
    assert row.geometry.dim == 2
    corners = row.geometry.x[compat.geometry_nodes(row)[:per_rank]]
    assert (np.floor(corners[:, :, 0].min(axis=1) / 2) == comm.rank).all()


def test_a_submesh_knows_its_parents(row, comm):
    dim = row.topology.dim
    row.topology.create_connectivity(dim, 0)
    middles = row.geometry.x[compat.geometry_nodes(row)].mean(axis=1)
    chosen = np.flatnonzero(middles[:, 0] > comm.size).astype(np.int32)
    part, cells, vertices = compat.create_submesh(row, chosen)
    assert np.array_equal(np.sort(cells), chosen)
    found = part.geometry.x[compat.geometry_nodes(part)].mean(axis=1)
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


def test_points_of_cells_and_elements(comm):
    square = mesh.create_unit_square(comm, 2, 2)
    nodes = compat.geometry_nodes(square)
    index_map = square.topology.index_map(2)
    assert nodes.shape == (index_map.size_local + index_map.num_ghosts, 3)
    corners = square.geometry.x[nodes][:, :, :2]
    edges = corners[:, 1:] - corners[:, :1]
    np.testing.assert_allclose(np.abs(np.linalg.det(edges)), 0.25)

    element = basix.ufl.quadrature_element("triangle", value_shape=(), degree=2)
    points = compat.interpolation_points(fem.functionspace(square, element))
    expected, _ = basix.make_quadrature(basix.CellType.triangle, 2)
    np.testing.assert_array_equal(points, expected)


def test_the_reason_of_numbers_that_are_not_finite(comm):
    """A solver whose residual is not a number ends with it, whatever it is called."""
    unknown = PETSc.Vec().createMPI(2, comm=MPI.COMM_SELF)
    matrix = PETSc.Mat().createDense((2, 2), comm=MPI.COMM_SELF)
    matrix.setUp()
    snes = PETSc.SNES().create(MPI.COMM_SELF)
    snes.setFunction(lambda snes, x, f: f.set(np.nan), unknown.duplicate())
    snes.setJacobian(lambda snes, x, J, P: None, matrix)
    snes.solve(None, unknown)
    assert snes.getConvergedReason() == compat.not_finite()


@pytest.mark.parametrize("version", ["0.9.0", "0.10.0.post5", "0.11.0.post0", "0.9.0.dev0+abc"])
def test_tested_versions_pass_without_a_word(version):
    assert compat.version_warning(version) is None


@pytest.mark.parametrize("version", ["0.8.0", "0.12.0.dev0", "1.0.0", "2019.2.0", "unknown"])
def test_other_versions_are_warned_of_with_those_that_are_tested(version):
    warning = compat.version_warning(version)
    assert warning is not None and warning.startswith(f"DOLFINx {version} is not")
    assert "0.9 to 0.11" in warning


@pytest.mark.ranks
def test_an_untested_version_is_warned_of_once(comm, monkeypatch, caplog):
    monkeypatch.setattr(compat.dolfinx, "__version__", "0.99.0")
    compat._warn_of_untested_version.cache_clear()
    points, cells = columns(MPI.COMM_SELF, "triangle")
    rank = np.zeros(len(cells), dtype=np.int32)
    offsets = np.arange(len(rank) + 1, dtype=np.int32)

    def partitioner(*_):
        return compat.destinations(rank, offsets)

    with caplog.at_level(logging.WARNING, logger="castx"):
        for _ in range(2):
            compat.create_linear_mesh(MPI.COMM_SELF, points, cells, "triangle", partitioner)
    compat._warn_of_untested_version.cache_clear()
    assert [record.message for record in caplog.records] == [compat.version_warning("0.99.0")]


def test_signals_keep_their_handlers_where_a_library_takes_them():
    noted = []
    before = signal.signal(signal.SIGUSR2, lambda number, _: noted.append(number))
    try:
        with compat.kept_signals():
            ctypes.CDLL(None).signal(signal.SIGUSR2, ctypes.c_void_p(0))
        os.kill(os.getpid(), signal.SIGUSR2)
    finally:
        signal.signal(signal.SIGUSR2, before)
    assert noted == [signal.SIGUSR2]
