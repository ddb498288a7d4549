"""The file of a body is what VTK reads, at every step, also after its writer was killed."""

from __future__ import annotations

import dataclasses
import signal
import subprocess
import sys
import time

import h5py
import numpy as np
import pytest
import pyvista
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

from castx.results.files.body_series import BodySeries
from castx.results.files.grown_file import set_step
from castx.results.files.vtkhdf import BodyFile
from castx.results.files.vtu import Piece

pytestmark = pytest.mark.serial

SQUARE = Piece(
    cells=2,
    nodes=np.arange(4),
    points=np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]),
    connectivity=np.array([0, 1, 2, 1, 3, 2]),
    kind=int(pyvista.CellType.TRIANGLE),
)
UNITS = {"temperature": "°C", "stress": "Pa"}


def body_file(folder, units=UNITS):
    return BodyFile(folder / "casting.hdf", "casting", 7, SQUARE, units)


def nodal(time):
    return {"temperature": np.arange(4.0) + time, "displacement": time * np.ones((4, 2))}


def cellwise(time):
    return {"stress": np.arange(12.0).reshape(2, 6) + time}


def read_by_vtk(path):
    """Return the times and the meshes of all steps, by the reader that ParaView has."""
    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.Update()
    key = vtkStreamingDemandDrivenPipeline.TIME_STEPS()
    times = reader.GetOutputInformation(0).Get(key) or ()
    meshes = []
    for moment in times:
        reader.UpdateTimeStep(moment)
        meshes.append(pyvista.wrap(reader.GetOutputDataObject(0)).copy())
    return list(times), meshes


def test_vtk_reads_every_step(tmp_path):
    file = body_file(tmp_path)
    for moment in (0.0, 0.25, 4.0):
        file.append(moment, nodal(moment), cellwise(moment))
    times, meshes = read_by_vtk(file.path)
    assert times == [0.0, 0.25, 4.0]
    for moment, grid in zip(times, meshes, strict=True):
        np.testing.assert_array_equal(grid.points, SQUARE.points)
        np.testing.assert_array_equal(grid.cell_connectivity, SQUARE.connectivity)
        np.testing.assert_array_equal(grid["temperature"], np.arange(4.0) + moment)
        np.testing.assert_array_equal(grid["displacement"][:, 2], 0.0)
        np.testing.assert_array_equal(grid["displacement"][:, :2], moment)
        expected = np.array([0.0, 1.0, 2.0, 3.0, 5.0, 4.0]) + moment  # VTK's order of a tensor
        np.testing.assert_array_equal(grid["stress"][0], expected)
        assert grid["body"].tolist() == [7, 7]


def test_pyvista_opens_the_file(tmp_path):
    file = body_file(tmp_path)
    file.append(3.0, nodal(3.0), cellwise(3.0))
    grid = pyvista.read(file.path)
    np.testing.assert_array_equal(grid["temperature"], np.arange(4.0) + 3.0)


def test_the_mesh_stands_there_once(tmp_path):
    file = body_file(tmp_path)
    for step in range(50):
        file.append(float(step), nodal(step), cellwise(step))
    with h5py.File(file.path) as archive:
        root = archive["VTKHDF"]
        assert root["Points"].shape == (4, 3) and root["Connectivity"].shape == (6,)
        assert root["CellData/body"].shape == (2,)
        assert root["PointData/temperature"].shape == (200,)
        assert root["PointData/temperature"].attrs["units"] == "°C"
        assert "units" not in root["PointData/displacement"].attrs
        assert root.attrs["name"] == "casting" and root.attrs["number"] == 7


def test_later_moments_are_trimmed_and_written_over(tmp_path):
    file = body_file(tmp_path)
    for moment in (0.0, 1.0, 2.0, 3.0):
        file.append(moment, nodal(moment), cellwise(moment))
    file.keep([0.0, 1.0])
    assert read_by_vtk(file.path)[0] == [0.0, 1.0]
    file.append(1.5, nodal(1.5), cellwise(1.5))
    times, meshes = read_by_vtk(file.path)
    assert times == [0.0, 1.0, 1.5]
    assert [grid["temperature"][0] for grid in meshes] == times
    file.keep([])
    assert not file.path.exists()
    file.keep([0.0])  # lost by its user: nothing to trim


def test_fields_may_change_when_a_run_goes_on(tmp_path):
    file = body_file(tmp_path)
    file.append(0.0, nodal(0.0), {})
    file.append(1.0, {"temperature": np.ones(4)}, cellwise(1.0))
    times, meshes = read_by_vtk(file.path)
    assert times == [0.0, 1.0]
    assert np.isnan(meshes[0]["stress"]).all() and np.isnan(meshes[1]["displacement"]).all()
    np.testing.assert_array_equal(meshes[0]["displacement"], 0.0)
    assert meshes[1]["stress"][1].tolist() == [7.0, 8.0, 9.0, 10.0, 12.0, 11.0]


@pytest.mark.parametrize("last", ["count", "time"])
def test_a_step_that_is_not_whole_is_written_over(tmp_path, monkeypatch, last):
    """A writer dies before it counts a step, or between that and the time of the step."""
    file = body_file(tmp_path)
    for moment in (0.0, 0.5):
        file.append(moment, nodal(moment), cellwise(moment))

    def killed(steps, step, entry):
        if last == "count" or steps.name.endswith("Values"):
            raise KeyboardInterrupt
        set_step(steps, step, entry)

    with monkeypatch.context() as patched:
        patched.setattr("castx.results.files.vtkhdf.set_step", killed)
        with pytest.raises(KeyboardInterrupt):
            file.append(1.0, nodal(1.0), cellwise(1.0))
    assert BodySeries(tmp_path).times == [0.0, 0.5]
    assert read_by_vtk(file.path)[0][:2] == [0.0, 0.5]
    with h5py.File(file.path) as archive:
        steps = archive["VTKHDF/Steps"]
        assert len(steps["Values"]) <= steps.attrs["NSteps"]  # VTK 9.3 would end the process
    file.append(1.25, nodal(1.25), cellwise(1.25))
    times, meshes = read_by_vtk(file.path)
    assert times == [0.0, 0.5, 1.25] and meshes[2]["temperature"][0] == 1.25


WRITER = """
import sys
from pathlib import Path
from tests.castx.results.files.test_vtkhdf import body_file, cellwise, nodal
file = body_file(Path(sys.argv[1]))
for step in range(10**6):
    file.append(float(step), nodal(step), cellwise(step))
    print(step, flush=True)
"""


def test_a_killed_writer_leaves_a_file_that_can_be_read(tmp_path):
    writer = subprocess.Popen(
        [sys.executable, "-c", WRITER, str(tmp_path)], stdout=subprocess.PIPE, text=True
    )
    while writer.stdout.readline() != "70\n":  # beyond the first node of the tree of pieces
        assert writer.poll() is None
    time.sleep(0.0137)
    writer.send_signal(signal.SIGKILL)
    writer.wait()
    said = [int(line) for line in writer.stdout.read().split()]
    whole = BodySeries(tmp_path).times
    assert len(whole) >= max([70, *said]) + 1 and whole == [float(n) for n in range(len(whole))]
    times, meshes = read_by_vtk(tmp_path / "casting.hdf")
    if len(times) > len(whole):
        # Killed between count and time: VTK takes the moment for t = 0 until the next one is there.
        moment = len(whole)
        body_file(tmp_path).append(float(moment), nodal(moment), cellwise(moment))
        times, meshes = read_by_vtk(tmp_path / "casting.hdf")
        whole = [*whole, float(moment)]
    assert times == whole
    for moment, grid in list(zip(times, meshes, strict=True))[-8:]:
        np.testing.assert_array_equal(grid["temperature"], np.arange(4.0) + moment)
        assert grid["stress"][0, 0] == moment


def test_a_reader_that_has_the_file_open_is_no_obstacle(tmp_path):
    file = body_file(tmp_path)
    file.append(0.0, nodal(0.0), cellwise(0.0))
    program = "import h5py, sys; f = h5py.File(sys.argv[1]); print(1, flush=True); sys.stdin.read()"
    reader = subprocess.Popen(
        [sys.executable, "-c", program, str(file.path)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE,
    )  # fmt: skip
    assert reader.stdout.readline()
    file.append(1.0, nodal(1.0), cellwise(1.0))
    reader.communicate()
    assert read_by_vtk(file.path)[0] == [0.0, 1.0]


def test_a_folder_that_is_not_there_is_a_failure_of_the_disk(tmp_path):
    with pytest.raises(OSError, match="none"):
        body_file(tmp_path / "none").append(0.0, nodal(0.0), cellwise(0.0))


def damaged(path, change):
    with h5py.File(path, "r+") as file:
        change(file["VTKHDF"])


def text_in(name):
    def change(root):
        del root[name]
        root[name] = "text"

    return change


@pytest.mark.parametrize(
    ("change", "missing"),
    [
        (lambda root: root.__delitem__("Steps"), "VTKHDF/Steps"),
        (lambda root: root["Steps"].attrs.__delitem__("NSteps"), "VTKHDF/Steps"),
        (text_in("Steps/Values"), "VTKHDF/Steps/Values"),
        (lambda root: root.__delitem__("PointData"), "VTKHDF/PointData"),
        (text_in("PointData"), "VTKHDF/PointData"),
        (text_in("PointData/temperature"), "VTKHDF/PointData/temperature"),
        (lambda root: root.__delitem__("CellData/stress"), "VTKHDF/CellData/stress"),
        (lambda root: root["Steps/CellOffsets"].resize(1, axis=0), "VTKHDF/Steps/CellOffsets"),
        (lambda root: root["Steps/PointDataOffsets/temperature"].resize(0, axis=0),
         "VTKHDF/Steps/PointDataOffsets/temperature"),
    ],
)  # fmt: skip
def test_a_file_that_lacks_something_is_refused_at_a_restart(tmp_path, change, missing):
    file = body_file(tmp_path)
    for moment in (0.0, 1.0):
        file.append(moment, nodal(moment), cellwise(moment))
    damaged(file.path, change)
    with pytest.raises(OSError, match=rf"damaged \({missing} is missing\); move it away") as caught:
        file.keep([0.0])
    assert caught.value.filename == str(file.path)


def test_another_file_in_its_place_is_refused_at_a_restart(tmp_path):
    file = body_file(tmp_path)
    file.path.write_bytes(b"no HDF5")
    with pytest.raises(OSError, match=r"damaged \(.*signature.*\); move it away"):
        file.keep([0.0])


@pytest.mark.parametrize(("name", "points"), [("mould", SQUARE.points), ("casting", np.eye(3))])
def test_the_file_of_another_body_is_refused_at_a_restart(tmp_path, name, points):
    piece = dataclasses.replace(SQUARE, points=points)
    BodyFile(tmp_path / "casting.hdf", name, 7, piece, UNITS).append(0.0, {}, {})
    before = (tmp_path / "casting.hdf").read_bytes()
    with pytest.raises(OSError, match=f"it holds {len(points)} points of '{name}', not the 4 of"):
        body_file(tmp_path).keep([0.0])
    assert (tmp_path / "casting.hdf").read_bytes() == before
