"""Files of bodies read back: what was written, and refusals of damaged files in words."""

from __future__ import annotations

import os

import h5py
import numpy as np
import pytest
import pyvista

from castx.errors import CaseError
from castx.results.files.body_series import BodySeries
from castx.results.files.vtkhdf import BodyFile
from castx.results.files.vtu import Piece

pytestmark = pytest.mark.serial

SQUARE = Piece(
    cells=1,
    nodes=np.arange(4),
    points=np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]),
    connectivity=np.array([0, 1, 2, 3]),
    kind=int(pyvista.CellType.QUAD),
)


@pytest.fixture
def folder(tmp_path):
    """Write the mould at two moments and the casting, which is the first body, at one."""
    mould = BodyFile(tmp_path / "a mould.hdf", "a mould", 1, SQUARE, {})
    casting = BodyFile(tmp_path / "casting.hdf", "casting", 0, SQUARE, {})
    mould.append(0.0, {"temperature": np.full(4, 20.0)}, {})
    casting.append(1.5, {"temperature": np.full(4, 700.0)}, {"von_mises": np.array([5.0])})
    mould.append(1.5, {"temperature": np.full(4, 25.0)}, {"von_mises": np.array([6.0])})
    return tmp_path


def test_bodies_come_back_in_their_order_while_they_are_there(folder):
    series = BodySeries(folder)
    assert series.times == [0.0, 1.5]
    assert list(series.read(0.0)) == series.bodies(0.0) == ["a mould"]
    assert series.bodies(1.5) == ["casting", "a mould"]
    bodies = series.read(1.5)
    assert list(bodies) == ["casting", "a mould"]
    assert (bodies["casting"]["temperature"] == 700.0).all()
    assert (bodies["a mould"]["temperature"] == 25.0).all()
    assert bodies["casting"]["von_mises"].tolist() == [5.0]
    assert bodies["casting"].celltypes.tolist() == [pyvista.CellType.QUAD]
    assert bodies["a mould"]["body"].tolist() == [1]
    np.testing.assert_array_equal(bodies["casting"].points, SQUARE.points)


def test_a_field_that_a_moment_lacks_is_not_there(folder):
    assert "von_mises" not in BodySeries(folder).read(0.0)["a mould"].cell_data
    assert "von_mises" in BodySeries(folder).read(1.5)["a mould"].cell_data


def test_files_that_are_being_made_are_passed_over(folder):
    (folder / ".casting.hdf.123").write_text("begun")
    (folder / ".core.hdf").write_text("begun")
    assert BodySeries(folder).times == [0.0, 1.5]


def test_an_empty_folder_has_no_times(tmp_path):
    assert BodySeries(tmp_path).times == []


def edited(edit):
    """Return what changes a file by a function of its root."""

    def spoil(path):
        with h5py.File(path, "r+") as file:
            edit(file["VTKHDF"])

    return spoil


def replaced(name, values):
    def edit(root):
        del root[name]
        root[name] = values

    return edited(edit)


def as_pipe(path):
    path.unlink()
    os.mkfifo(path)


@pytest.mark.parametrize(
    "spoil",
    [
        lambda path: path.write_bytes(b""),
        lambda path: path.write_bytes(path.read_bytes()[:3000]),
        lambda path: path.write_text("text"),
        edited(lambda root: root.attrs.__delitem__("number")),
        edited(lambda root: root["Steps"].attrs.__setitem__("NSteps", "many")),
        edited(lambda root: root.__delitem__("Steps")),
        edited(lambda root: root.__delitem__("Points")),
        replaced("Connectivity", np.array([0, 1, 2, 4])),
        replaced("Connectivity", np.array([0, 1, 2, -1])),
        replaced("PointData/temperature", np.array([1.0, 2.0])),
        replaced("Steps/PointDataOffsets/temperature", np.array([3])),
        replaced("Types", np.array([255])),
        edited(lambda root: root.attrs.__setitem__("name", "a mould")),
        as_pipe,
    ],
)
def test_damaged_files_are_refused_with_their_name(folder, capfd, spoil):
    spoil(folder / "casting.hdf")
    with pytest.raises(CaseError, match=r"casting.hdf is missing or damaged: \S"):
        BodySeries(folder).read(1.5)
    assert capfd.readouterr().err == ""


def test_times_that_do_not_ascend_are_refused(folder):
    replaced("Steps/Values", np.array([1.5, 0.0]))(folder / "a mould.hdf")
    with pytest.raises(CaseError, match=r"mould\.hdf is .*its times do not ascend"):
        BodySeries(folder)
