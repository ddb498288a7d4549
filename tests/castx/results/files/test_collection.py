"""The collection of written fields: each body whole, from the pieces of all ranks."""

from __future__ import annotations

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
    assert list(bodies) == ["a", "b"]
    assert bodies["a"].n_cells == 4 and bodies["a"].n_points == 10
    assert bodies["a"].bounds[:2] == (0.0, 4.0)
    assert (bodies["b"]["temperature"] == 2.0).all()


def test_a_body_that_is_gone_is_left_out(folder):
    assert list(FieldSeries(folder).read(1.5)) == ["b"]


def test_missing_fields_are_refused(tmp_path):
    with pytest.raises(CaseError, match="there are no fields"):
        FieldSeries(tmp_path)
