"""The view cuts bodies at each moment where pictures do, large ones with walls of pipes."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import pyvista

from castx.report import browser_scene as module
from castx.report.browser_scene import scene
from castx.report.packing import unpacked
from castx.report.sunk_bodies import Pipes, passing, surface_of
from castx.results.files.run_tables import Columns
from castx.results.sunk_shape import pipe_level, without_pipe
from tests.castx.handover.made_results import CELLS, box
from tests.castx.report.drawn_scenes import area, drawn, surface

pytestmark = pytest.mark.serial

SIZES = (0.03, 0.02, 0.01)
TIMES = [0.0, 1.0, 2.0]


def bowl(time, corners=4):
    """Return a body whose metal sinks over time to a bowl of a growing radius."""
    points, cells = box(corners, (9, 7, 5), SIZES)
    grid = pyvista.UnstructuredGrid({CELLS["3d", cells.shape[1]]: cells}, points)
    grid.points = points
    away = np.linalg.norm(points - [0.015, 0.01, 0.01], axis=1)
    grid["emptied"] = np.clip(0.7 * time - away / 0.008, 0.0, 1.0)
    grid["temperature"] = 600.0 - 10.0 * time + 1e3 * points[:, 0]
    grid["displacement"] = 1e-2 * time * points
    grid.cell_data["von_mises"] = np.full(grid.n_cells, 1e6 * time)
    return grid


def results(corners=4):
    history = {"time": np.array(TIMES), "casting.solid_fraction": np.linspace(0, 1, len(TIMES))}
    return SimpleNamespace(
        times=TIMES, grids=lambda time=TIMES[-1]: {"casting": bowl(time, corners)}, model="3d",
        freezing=["casting"], bodies=("casting",), history=Columns(history),
        record={"interfaces": {}, "process": [], "front": "f_s = 0.9"},
    )  # fmt: skip


def test_levels_and_cells_of_a_pipe():
    states = [{"casting": bowl(time), "mould": pyvista.UnstructuredGrid()} for time in TIMES]
    found = Pipes.of("3d", states)
    levels = [pipe_level(bowl(time), "3d") for time in TIMES]
    assert levels[0] is None and found.levels == {"casting": levels}
    for time, level in zip(TIMES[1:], levels[1:], strict=True):
        assert set(passing(bowl(time), level)) <= set(found.cells["casting"])
    assert 0 < len(passing(bowl(2.0), levels[2])) < len(found.cells["casting"]) < bowl(2.0).n_cells


def test_the_surface_of_a_large_body_has_the_cells_of_its_pipe():
    grid, cells = bowl(2.0), np.array([5, 17])
    found = surface_of(grid, cells)
    faces = grid.extract_surface().triangulate()
    assert list(found.cells_dict) == [pyvista.CellType.TRIANGLE, pyvista.CellType.TETRA]
    assert len(found.cells_dict[pyvista.CellType.TRIANGLE]) == faces.n_cells
    inner = np.asarray(found.points)[found.cells_dict[pyvista.CellType.TETRA]]
    np.testing.assert_array_equal(inner, np.asarray(grid.points)[grid.cells_dict[10][cells]])
    assert found["von_mises"].shape == (faces.n_cells + 2,)
    assert surface_of(grid, np.empty(0, dtype=np.int64)).n_cells == faces.n_cells


def test_a_scene_has_the_levels_of_its_moments():
    found = scene(results())
    levels = [pipe_level(bowl(time), "3d") for time in TIMES]
    assert found["pipes"] == {"field": "emptied", "levels": {"casting": levels}}
    assert found["bodies"]["casting"]["inner"] is None


@pytest.mark.parametrize("corners", [4, 8])
@pytest.mark.parametrize("hollow", [False, True])
def test_what_is_drawn_has_the_area_of_what_is_left(hollow, corners, tmp_path, monkeypatch):
    """Hexahedra are cut as tetrahedra here and otherwise there, within 2 %."""
    if hollow:
        monkeypatch.setattr(module, "LARGEST_MESH", 0)
    run = results(corners)
    found = scene(run)
    if hollow:
        assert unpacked(found["bodies"]["casting"]["inner"]).shape[1] == 4
    shows = [{"moment": m, "field": "temperature"} for m in (0, 1, 2)] + [{"field": "emptied"}]
    *moments, whole = (area(seen) for seen in drawn(found, "casting", shows, tmp_path))
    left = [surface(without_pipe(bowl(time, corners), "3d")) for time in TIMES]
    assert moments == pytest.approx(left, rel=1e-4 if corners == 4 else 0.02)
    assert whole == pytest.approx(left[0], rel=1e-6) and left[0] < 0.95 * left[2]


def test_a_cut_through_a_pipe_leaves_its_bowl(tmp_path):
    """Behind x = 15 mm, grown by a tenth of the displacements, 2 % of the size."""
    level, factor = 0.0151, 5.0
    shows = [{"moment": 2, "field": "temperature", "factor": factor,
              "plane": {"normal": [1, 0, 0], "offset": level}}]  # fmt: skip
    (seen,) = drawn(scene(results()), "casting", shows, tmp_path)
    left = without_pipe(bowl(2.0), "3d").clip("x", origin=(level, 0.0, 0.0))
    assert area(seen) == pytest.approx(surface(left) * (1 + 0.02 * factor) ** 2, rel=1e-3)
    assert seen[..., 0].max() == pytest.approx(level * (1 + 0.02 * factor), rel=1e-4)
