"""The reader of foreign fields: interpolation, links in HDF5 files, and its limit of memory."""

import subprocess
import sys
from pathlib import Path

import h5py
import meshio
import numpy as np
import pytest
from vtkmodules.vtkCommonDataModel import vtkGenericCell

from castx.heat.foreign import child
from castx.results.files.vtkhdf import BodyFile
from castx.results.files.vtu import Piece

pytestmark = pytest.mark.serial

SQUARE = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 1.0, 0.0]])


def saved(path: Path, cells: list, field: str = "T") -> Path:
    values = 3.0 * SQUARE[:, 0] - SQUARE[:, 1]
    meshio.Mesh(SQUARE, cells, point_data={field: values}).write(path)
    return path


@pytest.mark.parametrize("suffix", [".vtu", ".xdmf"])
def test_a_linear_field_comes_back(tmp_path, suffix):
    path = saved(tmp_path / f"a{suffix}", [("triangle", [[0, 1, 2], [1, 3, 2]])])
    points = np.array([[0.5, 0.25], [1.7, 0.9], [3.0, 0.5]])
    values, distances, sizes = child.values_at(path, "T", points)
    np.testing.assert_allclose(values, [1.25, 4.2, 5.5], rtol=1e-12)
    np.testing.assert_allclose(distances, [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(sizes, np.sqrt(5.0))


def test_cells_of_other_dimensions_are_left_out_with_their_points(tmp_path):
    path = saved(tmp_path / "a.vtu", [("triangle", [[0, 1, 2]]), ("line", [[1, 3]])])
    values, distances, _ = child.values_at(path, "T", np.array([[2.0, 1.0]]))
    np.testing.assert_allclose((values[0], distances[0]), (3.0 * 1.6 - 0.2, np.hypot(0.4, 0.8)))


@pytest.mark.parametrize("dimension, words", [(2, "triangles or quad"), (3, "tetrahedra, hexa")])
def test_cells_of_no_fitting_dimension_are_refused(tmp_path, dimension, words):
    path = saved(tmp_path / "a.vtu", [("line", [[0, 1], [1, 3]])])
    with pytest.raises(child.Refused, match=f"the model needs cells that are {words}"):
        child.values_at(path, "T", np.zeros((1, dimension)))


def test_of_a_series_the_last_moment_counts(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # where meshio puts the numbers
    path, triangles = tmp_path / "a.xdmf", [("triangle", np.array([[0, 1, 2], [1, 3, 2]]))]
    with meshio.xdmf.TimeSeriesWriter(path) as writer:
        writer.write_points_cells(SQUARE, triangles)
        for moment in (1.0, 2.0, 3.0):
            writer.write_data(moment, point_data={"T": moment * SQUARE[:, 0]})
    values = child.values_at(path, "T", np.array([[0.5, 0.25]]))[0]
    np.testing.assert_allclose(values, 3.0 * 0.5)


@pytest.mark.parametrize("name", child.VTK_NUMBERS)
def test_cells_of_meshio_are_those_of_vtk(tmp_path, name):
    """Meshio writes a cell of the kind, and VTK says what it has read."""
    number = child.VTK_NUMBERS[name]
    cell = vtkGenericCell()
    cell.SetCellType(number)
    count = cell.GetNumberOfPoints()
    points = np.random.default_rng(1).random((count, 3))
    meshio.Mesh(points, [(name, [list(range(count))])]).write(tmp_path / "a.vtu")
    assert child.kinds_of(child.read_vtu(tmp_path / "a.vtu")).tolist() == [number]


@pytest.mark.parametrize("number", child.CORNERS)
def test_a_cell_has_the_points_of_its_kind(number):
    cell = vtkGenericCell()
    cell.SetCellType(number)
    assert child.CORNERS[number] == cell.GetNumberOfPoints()


def test_a_place_in_hdf5_must_lie_in_the_file_itself(tmp_path):
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["x"] = np.arange(3.0)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["group/x"] = np.arange(3.0)
        file["soft"] = h5py.SoftLink("/group/x")
        file["outside"] = h5py.ExternalLink("other.h5", "/x")
        layout = h5py.VirtualLayout(3, "f8")
        layout[:] = h5py.VirtualSource("other.h5", "x", 3)
        file.create_virtual_dataset("virtual", layout)
    child.check_place(tmp_path / "a.h5", "/group/x")
    for inside in ("/soft", "/outside", "/virtual", "/none", "/group/x/y"):
        with pytest.raises(child.Refused, match=rf"a.h5( holds no |:){inside}"):
            child.check_place(tmp_path / "a.h5", inside)


def test_memory_is_limited():
    code = (
        f"import runpy; child = runpy.run_path({child.__file__!r}, run_name='child')\n"
        "child['limit_memory'](100_000_000)\n"
        "import numpy; numpy.ones(5_000_000); print('enough', flush=True)\n"
        "numpy.ones(20_000_000)"
    )
    ended = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=60
    )
    assert ended.stdout == "enough\n" and "MemoryError" in ended.stderr


def body_file(folder: Path, *moments: float) -> Path:
    """Write a square of two triangles, whose field grows with time."""
    corners = np.column_stack([SQUARE[:, :2], np.zeros(len(SQUARE))])
    mesh = Piece(2, np.arange(4), corners, np.array([0, 1, 2, 1, 3, 2]), 5)
    file = BodyFile(folder / "casting.hdf", "casting", 0, mesh, {})
    for moment in moments:
        file.append(moment, {"T": moment * SQUARE[:, 0]}, {"body_number": np.zeros(2)})
    return file.path


def test_of_the_file_of_a_body_the_last_moment_counts(tmp_path):
    path = body_file(tmp_path, 1.0, 2.0, 3.0)
    values, distances, _ = child.values_at(path, "T", np.array([[0.5, 0.25], [1.5, 0.5]]))
    np.testing.assert_allclose(values, [1.5, 4.5])
    np.testing.assert_allclose(distances, 0.0, atol=1e-12)


def test_a_body_without_a_moment_or_with_a_mesh_that_changes_is_refused(tmp_path):
    path = body_file(tmp_path, 1.0)
    with h5py.File(path, "r+") as file:
        file["VTKHDF/Steps/PointOffsets"][0] = 4
    with pytest.raises(child.Refused, match="no moment in it, or a mesh that changes"):
        child.values_at(path, "T", np.zeros((1, 2)))
    with h5py.File(path, "r+") as file:
        file["VTKHDF/Steps/PointOffsets"][0] = 0
        file["VTKHDF/Steps"].attrs["NSteps"] = 0
    with pytest.raises(child.Refused, match="no moment in it"):
        child.values_at(path, "T", np.zeros((1, 2)))


@pytest.mark.parametrize("place", ["Points", "PointData/T", "Steps/PointDataOffsets/T"])
def test_a_body_whose_numbers_lie_in_another_file_is_refused(tmp_path, place):
    path = body_file(tmp_path, 1.0)
    with h5py.File(path, "r+") as file:
        del file[f"VTKHDF/{place}"]
        file[f"VTKHDF/{place}"] = h5py.ExternalLink("pipe", "/numbers")
    with pytest.raises(child.Refused, match=r"holds no .* of its own"):
        child.values_at(path, "T", np.zeros((1, 2)))


def test_a_damaged_body_cannot_be_read(tmp_path):
    path = body_file(tmp_path, 1.0)
    path.write_bytes(path.read_bytes()[:3000])
    with pytest.raises(child.Unreadable, match="h5py says: OSError"):
        child.values_at(path, "T", np.zeros((1, 2)))
