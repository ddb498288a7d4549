"""Structured meshes: exact volumes, conforming, symmetric."""

import numpy as np
import pytest

from castx.meshes.linear_mesh import free_faces, handedness, mirrored
from castx.meshes.structured import grid, swept

pytestmark = pytest.mark.serial

X = np.array([0.0, 0.1, 0.4, 1.0, 1.1])
Y = np.array([0.0, 0.5, 0.6, 2.0])
Z = np.array([0.0, 0.3, 0.5, 1.5])


def one_region(middle):
    return np.zeros(len(middle), dtype=int)


BOTH = pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
SHARE = {(2, 3): 1 / 2, (2, 4): 1.0, (3, 4): 1 / 6, (3, 8): 1.0}
"""Volume of a cell, by dimension and corners, in units of its edges at a corner: upright boxes."""


def volumes(mesh):
    return handedness(mesh.points, mesh.cells) * SHARE[mesh.dimension, mesh.cells.shape[1]]


def cell_set(mesh, turn=None):
    """Cells as a set of corner positions, after a turn of the points."""
    points = mesh.points if turn is None else turn(mesh.points)
    return {frozenset(map(tuple, np.round(points[cell], 9) + 0.0)) for cell in mesh.cells}


def reflected(axis, value=0.0):
    def turn(points):
        image = points.copy()
        image[:, axis] = 2 * value - image[:, axis]
        return image

    return turn


def test_grid_fills_the_rectangle_with_right_angled_triangles():
    mesh = grid(X, Y, one_region)
    assert volumes(mesh).min() > 0
    assert volumes(mesh).sum() == pytest.approx(1.1 * 2.0, rel=1e-14)
    corners = mesh.points[mesh.cells]
    sides = np.sort(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2) ** 2, axis=1)
    assert np.allclose(sides[:, 0] + sides[:, 1], sides[:, 2])


def test_quadrilaterals_are_the_rectangles_of_the_grid():
    mesh = grid(X, Y, one_region, "quadrilaterals")
    sizes = np.outer(np.diff(X), np.diff(Y)).ravel()
    assert np.allclose(np.sort(volumes(mesh)), np.sort(sizes), rtol=1e-14)


@BOTH
def test_grid_leaves_out_negative_regions(cells):
    mesh = grid(X, Y, lambda m: np.where((m[:, 0] > 0.4) & (m[:, 1] > 0.6), -1, 0), cells)
    assert volumes(mesh).sum() == pytest.approx(1.1 * 2.0 - 0.7 * 1.4)
    assert len(mesh.points) == 5 * 4 - 2


@BOTH
def test_grid_mirrors_itself_about_the_middle_of_an_even_number_of_cells(cells):
    mesh = grid(np.linspace(0, 1, 7), np.linspace(0, 2, 5), one_region, cells)
    for axis, middle in ((0, 0.5), (1, 1.0)):
        assert cell_set(mesh, reflected(axis, middle)) == cell_set(mesh)


@pytest.mark.parametrize("i", range(1, 4))
@pytest.mark.parametrize("j", [1, 2])
def test_no_triangle_lies_in_the_corner_of_a_region_with_all_its_nodes(i, j):
    plan = grid(X, Y, lambda m: ((m[:, 0] < X[i]) & (m[:, 1] < Y[j])).astype(int), corner=(i, j))
    for level in (1, 2):
        solid = swept(plan, Z, lambda body, z, level=level: body * (z > Z[level]), corner=level)
        for mesh in (plan, solid):
            outside = np.zeros(len(mesh.points), dtype=bool)
            outside[mesh.cells[mesh.regions == 0]] = True
            assert not outside[mesh.cells[mesh.regions == 1]].all(axis=1).any()


@BOTH
def test_swept_cells_fill_the_box_and_share_their_faces(cells):
    mesh = swept(grid(X, Y, one_region, cells), Z, lambda regions, z: regions)
    assert volumes(mesh).min() > 0
    assert volumes(mesh).sum() == pytest.approx(1.1 * 2.0 * 1.5, rel=1e-14)
    faces = mesh.points[free_faces(mesh)]
    normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, -1] - faces[:, 0])
    area = (0.5 if cells == "simplices" else 1.0) * np.linalg.norm(normals, axis=1).sum()
    assert area == pytest.approx(2 * (1.1 * 2.0 + 1.1 * 1.5 + 2.0 * 1.5), rel=1e-14)


@BOTH
def test_swept_grid_mirrors_itself_in_all_directions(cells):
    plan = grid(np.linspace(0, 1, 5), np.linspace(0, 1, 3), one_region, cells)
    mesh = swept(plan, np.linspace(0, 1, 5), lambda regions, z: regions)
    for axis in range(3):
        assert cell_set(mesh, reflected(axis, 0.5)) == cell_set(mesh)


@BOTH
def test_swept_layers_can_change_region_or_end(cells):
    def lower_only_under_one(regions, z):
        return np.where(regions == 1, 1, 0 if z < 0.3 else -1)

    plan = grid(X, Y, lambda m: (m[:, 0] < 0.4).astype(int), cells)
    mesh = swept(plan, Z, lower_only_under_one)
    volume = volumes(mesh)
    assert volume[mesh.regions == 0].sum() == pytest.approx(0.7 * 2.0 * 0.3)
    assert volume[mesh.regions == 1].sum() == pytest.approx(0.4 * 2.0 * 1.5)


@BOTH
def test_mirrored_mesh_holds_the_original_and_its_image(cells):
    half = grid(X, Y, one_region, cells)
    whole = mirrored(half, 0)
    assert cell_set(whole) == cell_set(half) | cell_set(half, reflected(0))
    assert len(whole.points) == 2 * len(half.points) - len(Y)
    assert volumes(whole).min() > 0
    solid = swept(whole, Z, lambda regions, z: regions)
    assert cell_set(solid, reflected(0)) == cell_set(solid)
    assert volumes(solid).min() > 0
