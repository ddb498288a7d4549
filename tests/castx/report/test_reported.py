"""Fields of a run are read once, and made fit to be seen."""

import numpy as np
import pytest
import pyvista

from castx.report.reported import (
    ReportedRun,
    add_principal_stress,
    take_sizes,
    widen_surfaces,
)
from castx.results.reading import Results

pytestmark = pytest.mark.serial


def test_the_largest_principal_stress_follows_from_the_stress_in_the_order_of_vtk():
    grid = pyvista.ImageData(dimensions=(2, 2, 1)).cast_to_unstructured_grid()
    # xx yy zz xy yz xz: shear yz of 3 beside yy = zz = 1 gives 4, and xx = 2.
    grid.cell_data["stress"] = np.array([[2.0, 1.0, 1.0, 0.0, 3.0, 0.0]])
    add_principal_stress(grid)
    assert grid.cell_data["largest_principal_stress"] == pytest.approx([4.0])
    grid.cell_data["largest_principal_stress"] = np.array([7.0])
    add_principal_stress(grid)
    assert grid.cell_data["largest_principal_stress"][0] == 7.0


def test_fields_are_read_once_and_doubts_are_said(monkeypatch, caplog):
    read = []

    def grids(self, time=None):
        read.append(time)
        body = pyvista.ImageData(dimensions=(2, 2, 1)).cast_to_unstructured_grid()
        return {"a": body} if time < 2.0 else {"b": body}

    monkeypatch.setattr(Results, "grids", grids)
    monkeypatch.setattr(Results, "__init__", lambda self, folder: None)
    monkeypatch.setattr(Results, "doubts", ["its last lines are lost"])
    monkeypatch.setattr(Results, "times", [0.0, 1.0, 2.0])
    monkeypatch.setattr(Results, "bodies_at", lambda self, t: ["a"] if t < 2.0 else ["b"])
    run = ReportedRun("folder")
    assert caplog.messages == ["its last lines are lost"]
    assert run.grids(1.0) is run.grids(1.0) and read == [1.0]
    assert run.nearest(None) == 2.0 and run.nearest(0.6) == 1.0
    assert run.nearest(None, "a") == 1.0
    assert read == [1.0], "which bodies are there is known without their fields"


def test_vectors_are_shown_by_their_size_and_lives_by_powers_of_ten():
    grid = pyvista.ImageData(dimensions=(5, 2, 1)).cast_to_unstructured_grid()
    grid.cell_data["heat_flux"] = np.array([[3.0, -4.0, 0.0], [0.0, 0.0, 7.0]] * 2)
    grid.cell_data["life"] = np.array([1e4, 2.0, np.inf, 0.0])
    take_sizes(grid)
    np.testing.assert_allclose(grid.cell_data["heat_flux"], [5.0, 7.0, 5.0, 7.0])
    np.testing.assert_allclose(grid.cell_data["life"], [4.0, np.log10(2.0), np.nan, np.nan])


def strip():
    """Return two rows of five squares, each two triangles, and its nodes."""
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(6.0), np.arange(3.0)))
    grid = pyvista.Plane(i_resolution=5, j_resolution=2).triangulate().cast_to_unstructured_grid()
    grid.points = np.column_stack([x, y, 0.0 * x])
    return grid, x, y


def test_what_stands_on_a_surface_is_one_cell_wide_in_the_plane():
    grid, x, y = strip()
    below = y == 0.0
    grid.point_data["deviation"] = np.where(below, 2.0 + x, np.nan)
    grid.point_data["niyama"] = np.where(below, 1.0, np.nan)
    widen_surfaces(grid)
    found = grid.point_data["deviation"]
    np.testing.assert_array_equal(found[below], 2.0 + x[below])
    beside, far = y == 1.0, y == 2.0
    assert np.abs(found[beside] - 2.0 - x[beside]).max() <= 1.0
    assert np.isnan(found[far]).all() and np.isnan(grid.point_data["niyama"][~below]).all()


def test_in_space_surfaces_are_seen_as_they_are():
    grid = pyvista.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid()
    grid = grid.triangulate()
    values = np.where(grid.points[:, 2] == 0.0, 1.0, np.nan)
    grid.point_data["deviation"] = values
    widen_surfaces(grid)
    np.testing.assert_array_equal(grid.point_data["deviation"], values)
