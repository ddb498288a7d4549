"""Pieces of bodies as VTK files: what pyvista reads is what was written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import pyvista
from vtkmodules.vtkCommonCore import vtkDataArray

from castx.results.files.vtu import Piece, write_piece
from tests.castx.fakes import cylinder_mesh

SQUARE = Piece(
    cells=2,
    nodes=np.arange(4),
    points=np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]),
    connectivity=np.array([0, 1, 2, 1, 3, 2]),
    kind=int(pyvista.CellType.TRIANGLE),
)


def test_a_piece_is_read_as_it_was_written(tmp_path):
    nodal = {"temperature": np.arange(4.0) / 3.0, "displacement": np.arange(8.0).reshape(4, 2)}
    cellwise = {"von_mises": np.array([1.0, 2.0]), "stress": np.arange(12.0).reshape(2, 6)}
    write_piece(tmp_path / "a.vtu", SQUARE, 7, nodal, cellwise)
    grid = pyvista.read(tmp_path / "a.vtu")
    np.testing.assert_array_equal(grid.points, SQUARE.points)
    np.testing.assert_array_equal(grid.cell_connectivity, SQUARE.connectivity)
    assert (grid.celltypes == SQUARE.kind).all()
    np.testing.assert_array_equal(grid["temperature"], nodal["temperature"])
    np.testing.assert_array_equal(grid["displacement"][:, :2], nodal["displacement"])
    np.testing.assert_array_equal(grid["displacement"][:, 2], 0.0)
    np.testing.assert_array_equal(grid["von_mises"], [1.0, 2.0])
    np.testing.assert_array_equal(grid["body"], [7, 7])


def test_files_name_their_body_and_the_units_of_their_fields(tmp_path):
    nodal, cellwise = {"temperature": np.arange(4.0)}, {"von_mises": np.array([1.0, 2.0])}
    units = {"temperature": "°C", "von_mises": "Pa", "niyama": "K^½ s^½/m"}
    write_piece(tmp_path / "a.vtu", SQUARE, 0, nodal, cellwise, name="casting", units=units)
    grid = pyvista.read(tmp_path / "a.vtu")
    assert list(grid.field_data["name"]) == ["casting"]
    for data in (grid.GetPointData(), grid.GetCellData()):
        for index in range(data.GetNumberOfArrays()):
            array = data.GetArray(index)
            label = array.GetInformation().Get(vtkDataArray.UNITS_LABEL())
            assert label == units.get(array.GetName())


def test_shear_stresses_come_in_the_order_of_vtk(tmp_path):
    """From xx yy zz xy xz yz to xx yy zz xy yz xz."""
    stress = np.array([[1.0, 2.0, 3.0, 12.0, 13.0, 23.0]] * 2)
    write_piece(tmp_path / "a.vtu", SQUARE, 0, {}, {"stress": stress})
    np.testing.assert_array_equal(
        pyvista.read(tmp_path / "a.vtu")["stress"][0], [1.0, 2.0, 3.0, 12.0, 23.0, 13.0]
    )


def test_a_place_that_takes_no_file_is_an_error(tmp_path):
    with pytest.raises(OSError, match=r"cannot write .*none/a\.vtu"):
        write_piece(tmp_path / "none" / "a.vtu", SQUARE, 0, {}, {})


def test_a_full_disk_is_an_error():
    with pytest.raises(OSError, match="No space left on device") as caught:
        write_piece(Path("/dev/full"), SQUARE, 0, {}, {})
    assert caught.value.filename == "/dev/full"


@pytest.mark.ranks
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_pieces_of_all_ranks_hold_every_cell_once(comm, cells):
    for body in cylinder_mesh(comm, cells=cells).bodies.values():
        piece = Piece.of(body)
        corners = piece.points[piece.connectivity].reshape(piece.cells, body.kind.corners, 3)
        order = [0, 1, 3, 2] if cells == "quadrilaterals" else [0, 1, 2]
        owned = body.points[body.nodes.dofmap.list[: piece.cells]][:, order]
        expected = np.pad(owned, ((0, 0), (0, 0), (0, 1)))
        np.testing.assert_array_equal(np.sort(corners, axis=1), np.sort(expected, axis=1))
        np.testing.assert_array_equal(piece.points[:, :2], body.points[piece.nodes])
        everywhere = comm.allreduce(piece.cells)
        assert everywhere == body.mesh.topology.index_map(2).size_global
