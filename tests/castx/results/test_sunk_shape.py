"""Bodies without their pipe: the volume that is cut off, and where, in closed form."""

from __future__ import annotations

import numpy as np
import pytest
import pyvista

from castx.results.reading import cells_of
from castx.results.sunk_shape import measured, simplices, without_pipe
from tests.castx.handover.made_results import CELLS, box

pytestmark = pytest.mark.serial

SIZES = (0.03, 0.02, 0.01)


def body(corners, emptied, model="3d"):
    points, cells = box(corners, (7, 5, 3), SIZES)
    kind = CELLS["3d" if model == "3d" else "plane", cells.shape[1]]
    grid = pyvista.UnstructuredGrid({kind: cells}, points)
    grid.points = points
    grid.point_data["emptied"] = emptied(points)
    return grid


def volume(grid, model):
    simple = simplices(grid)
    return measured(np.asarray(simple.points, dtype=float)[cells_of(simple)], model).sum()


@pytest.mark.parametrize(
    ("corners", "model", "axis", "level"),
    [
        (4, "3d", 2, 0.5),
        (8, "3d", 2, 0.5),
        (3, "plane-strain", 1, 0.5),
        (-4, "plane-strain", 1, 0.5),
        (3, "axisymmetric", 1, 0.5),
        (3, "axisymmetric", 0, np.sqrt(1 / 3)),  # ∫ 2π r² dr = 2/3 of the volume = 1 - c²
    ],
)
def test_a_linear_share_is_cut_where_the_volumes_agree(corners, model, axis, level):
    grid = body(corners, lambda x: x[:, axis] / SIZES[axis], model)
    left = without_pipe(grid, model)
    assert left.bounds[2 * axis + 1] == pytest.approx(level * SIZES[axis], rel=1e-6)
    share = level**2 if model == "axisymmetric" and axis == 0 else level
    assert volume(left, model) == pytest.approx(share * volume(grid, model), rel=1e-9)


def test_a_bowl_is_cut_out_with_its_volume():
    def emptied(x):
        away = np.linalg.norm(x - [0.015, 0.01, 0.01], axis=1)
        return np.clip(1.2 - away / 0.008, 0.0, 1.0)

    grid = body(4, emptied)
    cells, values = cells_of(grid), np.asarray(grid["emptied"])
    volumes = measured(np.asarray(grid.points)[cells], "3d")
    pipe = volumes @ values[cells].mean(axis=1)
    left = without_pipe(grid, "3d")
    assert volume(grid, "3d") - volume(left, "3d") == pytest.approx(pipe, rel=1e-9)
    assert left.bounds == pytest.approx(grid.bounds)  # it lies inside of the top


@pytest.mark.parametrize("share", [0.0, 1e-12])
def test_without_a_pipe_the_body_is_whole(share):
    grid = body(4, lambda x: share * x[:, 2] / SIZES[2])
    assert without_pipe(grid, "3d") is grid
    bare = pyvista.UnstructuredGrid(grid)
    bare.point_data.clear()
    assert without_pipe(bare, "3d") is bare
