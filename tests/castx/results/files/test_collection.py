"""The collection of written fields: each body whole, from the pieces of all ranks."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
import pyvista

from castx.errors import CaseError
from castx.results.files.collection import FieldSeries

pytestmark = pytest.mark.serial


def piece(folder, name, left, temperature):
    """Write a row of two squares that begins at x = left."""
    grid = pyvista.ImageData(dimensions=(3, 2, 1), origin=(left, 0.0, 0.0))
    grid = grid.cast_to_unstructured_grid()
    grid["temperature"] = np.full(grid.n_points, temperature)
    grid.save(folder / name)


@pytest.fixture
def folder(tmp_path):
    fields = tmp_path / "fields"
    fields.mkdir()
    piece(fields, "a_0.vtu", 0.0, 1.0)
    piece(fields, "a_1.vtu", 2.0, 1.0)
    piece(fields, "b_0.vtu", 9.0, 2.0)
    sets = [("0.0", "a", "a_0"), ("0.0", "a", "a_1"), ("0.0", "b", "b_0"), ("1.5", "b", "b_0")]
    lines = "".join(
        f'<DataSet timestep="{time}" group="{body}" part="0" file="{file}.vtu"/>'
        for time, body, file in sets
    )
    text = f'<VTKFile type="Collection" version="1.0"><Collection>{lines}</Collection></VTKFile>'
    (fields / "castx.pvd").write_text(text)
    return tmp_path


def test_pieces_are_joined_at_their_common_points(folder):
    series = FieldSeries(folder)
    assert series.times == [0.0, 1.5]
    bodies = series.read(0.0)
    assert list(bodies) == series.bodies(0.0) == ["a", "b"]
    assert bodies["a"].n_cells == 4 and bodies["a"].n_points == 10
    assert bodies["a"].bounds[:2] == (0.0, 4.0)
    assert (bodies["b"]["temperature"] == 2.0).all()


def test_a_body_that_is_gone_is_left_out(folder):
    series = FieldSeries(folder)
    assert list(series.read(1.5)) == series.bodies(1.5) == ["b"]


def test_missing_fields_are_refused(tmp_path):
    with pytest.raises(CaseError, match="there are no fields"):
        FieldSeries(tmp_path)


def test_a_folder_that_may_not_be_looked_into_is_named(tmp_path, monkeypatch):
    def refuse(path):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(Path, "is_file", refuse)
    with pytest.raises(CaseError, match="fields cannot be read: Permission denied"):
        FieldSeries(tmp_path)


@pytest.mark.parametrize("left", [0, 40, 300])
def test_a_collection_that_is_cut_short_is_refused(folder, left):
    path = folder / "fields" / "castx.pvd"
    path.write_bytes(path.read_bytes()[:left])
    with pytest.raises(CaseError, match=r"castx.pvd is damaged"):
        FieldSeries(folder)


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        ("/etc/a_1.vtu", r"/etc/a_1\.vtu is not the name"),
        ("../a_1.vtu", r"\.\./a_1\.vtu is not the name"),
        ("a_0.vtu", r"a_0\.vtu is there twice"),
    ],
)
def test_a_collection_of_other_files_is_refused(folder, changed, why):
    path = folder / "fields" / "castx.pvd"
    path.write_text(path.read_text().replace('"a_1.vtu"', f'"{changed}"'))
    with pytest.raises(CaseError, match=rf"castx\.pvd is damaged: {why}"):
        FieldSeries(folder)


def as_pipe(path):
    path.unlink()
    os.mkfifo(path)


@pytest.mark.parametrize(
    "spoil",
    [
        lambda path: path.unlink(),
        lambda path: path.write_bytes(b""),
        lambda path: path.write_bytes(path.read_bytes()[:-400]),
        lambda path: path.write_bytes(path.read_bytes().replace(b"NumberOfPoints=", b"Points=")),
        lambda path: path.write_bytes(path.read_bytes().replace(b"Float64", b"Float65")),
        as_pipe,
    ],
)
def test_damaged_fields_are_refused_with_their_file(folder, capfd, spoil):
    spoil(folder / "fields" / "a_1.vtu")
    with pytest.raises(CaseError, match=r"a_1.vtu is (missing or )?damaged"):
        FieldSeries(folder).read(0.0)
    assert capfd.readouterr().err == ""
