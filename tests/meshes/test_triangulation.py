"""Structured triangles and tetrahedra: exact volumes, conforming, symmetric."""

import numpy as np
import pytest

from castx.meshes.model import free_faces
from castx.meshes.triangulation import grid, mirrored, swept, volumes

pytestmark = pytest.mark.serial

X = np.array([0.0, 0.1, 0.4, 1.0, 1.1])
Y = np.array([0.0, 0.5, 0.6, 2.0])
Z = np.array([0.0, 0.3, 0.5, 1.5])


def one_region(middle):
    return np.zeros(len(middle), dtype=int)


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
    assert volumes(mesh.points, mesh.cells).min() > 0
    assert volumes(mesh.points, mesh.cells).sum() == pytest.approx(1.1 * 2.0, rel=1e-14)
    corners = mesh.points[mesh.cells]
    sides = np.sort(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2) ** 2, axis=1)
    assert np.allclose(sides[:, 0] + sides[:, 1], sides[:, 2])


def test_grid_leaves_out_negative_regions():
    mesh = grid(X, Y, lambda m: np.where((m[:, 0] > 0.4) & (m[:, 1] > 0.6), -1, 0))
    assert volumes(mesh.points, mesh.cells).sum() == pytest.approx(1.1 * 2.0 - 0.7 * 1.4)
    assert len(mesh.points) == 5 * 4 - 2


def test_grid_mirrors_itself_about_the_middle_of_an_even_number_of_cells():
    mesh = grid(np.linspace(0, 1, 7), np.linspace(0, 2, 5), one_region)
    for axis, middle in ((0, 0.5), (1, 1.0)):
        assert cell_set(mesh, reflected(axis, middle)) == cell_set(mesh)


def test_swept_triangles_fill_the_box_and_share_their_faces():
    mesh = swept(grid(X, Y, one_region), Z, lambda regions, z: regions)
    assert volumes(mesh.points, mesh.cells).min() > 0
    assert volumes(mesh.points, mesh.cells).sum() == pytest.approx(1.1 * 2.0 * 1.5, rel=1e-14)
    faces = mesh.points[free_faces(mesh.cells)]
    normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    area = 0.5 * np.linalg.norm(normals, axis=1).sum()
    assert area == pytest.approx(2 * (1.1 * 2.0 + 1.1 * 1.5 + 2.0 * 1.5), rel=1e-14)


def test_swept_grid_mirrors_itself_in_all_directions():
    plan = grid(np.linspace(0, 1, 5), np.linspace(0, 1, 3), one_region)
    mesh = swept(plan, np.linspace(0, 1, 5), lambda regions, z: regions)
    for axis in range(3):
        assert cell_set(mesh, reflected(axis, 0.5)) == cell_set(mesh)


def test_swept_layers_can_change_region_or_end():
    def lower_only_under_one(regions, z):
        return np.where(regions == 1, 1, 0 if z < 0.3 else -1)

    plan = grid(X, Y, lambda m: (m[:, 0] < 0.4).astype(int))
    mesh = swept(plan, Z, lower_only_under_one)
    volume = volumes(mesh.points, mesh.cells)
    assert volume[mesh.regions == 0].sum() == pytest.approx(0.7 * 2.0 * 0.3)
    assert volume[mesh.regions == 1].sum() == pytest.approx(0.4 * 2.0 * 1.5)


def test_mirrored_mesh_holds_the_original_and_its_image():
    half = grid(X, Y, one_region)
    whole = mirrored(half, 0)
    assert cell_set(whole) == cell_set(half) | cell_set(half, reflected(0))
    assert len(whole.points) == 2 * len(half.points) - len(Y)
    assert volumes(whole.points, whole.cells).min() > 0
    solid = swept(whole, Z, lambda regions, z: regions)
    assert cell_set(solid, reflected(0)) == cell_set(solid)
