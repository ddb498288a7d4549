"""Fields of a run are read once, with the largest principal stress."""

import numpy as np
import pytest
import pyvista

from castx.report.reported import ReportedRun, add_principal_stress
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


def test_fields_are_read_once(monkeypatch):
    read = []

    def grids(self, time=None):
        read.append(time)
        body = pyvista.ImageData(dimensions=(2, 2, 1)).cast_to_unstructured_grid()
        return {"a": body} if time < 2.0 else {"b": body}

    monkeypatch.setattr(Results, "grids", grids)
    monkeypatch.setattr(Results, "__init__", lambda self, folder: None)
    monkeypatch.setattr(Results, "times", [0.0, 1.0, 2.0])
    run = ReportedRun("folder")
    assert run.grids(1.0) is run.grids(1.0) and read == [1.0]
    assert run.nearest(None) == 2.0 and run.nearest(0.6) == 1.0
    assert run.nearest(None, "a") == 1.0
