"""The next mesh has the cells that were asked for, small where the errors are."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import Delaunay

from castx.discretisation.new_sizes import SMALLEST, ErringMesh, simplex_volumes

pytestmark = pytest.mark.serial

FILLING = 0.5


def grid(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return points and triangles of a unit square."""
    line = np.linspace(0.0, 1.0, count + 1)
    points = np.array([[x, y] for x in line for y in line])
    return points, np.asarray(Delaunay(points + 1e-6 * points**2).simplices, dtype=np.int64)


def counted(points, cells, sizes) -> float:
    volumes = simplex_volumes(points, cells)
    return float(np.sum(volumes / (FILLING * sizes[cells].mean(axis=1) ** 2)))


def test_volumes_of_simplices_fill_the_whole():
    points, cells = grid(4)
    assert simplex_volumes(points, cells).sum() == pytest.approx(1.0)
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]], dtype=np.float64)
    assert simplex_volumes(corners, np.array([[0, 1, 2, 3]])) == pytest.approx([1.0])


@pytest.mark.parametrize("growth", [1.5, 2.0, 3.0])
def test_there_are_as_many_cells_as_asked_for(growth):
    points, cells = grid(16)
    middles = points[cells].mean(axis=1)
    squares = np.exp(-8.0 * middles[:, 0])
    found = ErringMesh(points, cells, squares, FILLING, slope=10.0).next_sizes(growth)
    assert counted(points, cells, found) == pytest.approx(growth * len(cells), rel=0.01)
    assert np.all(found <= np.sqrt(simplex_volumes(points, cells).max() / FILLING) * (1 + 1e-9))
    assert np.corrcoef(points[:, 0], found)[0, 1] > 0.8


def test_cells_of_one_error_become_small_alike_and_errors_are_equal_behind():
    """New sizes over present ones are the errors to the power of -1/(p + d/2)."""
    points, cells = grid(16)
    squares = np.where(points[cells].mean(axis=1)[:, 0] < 0.5, 4.0, 1.0)
    found = ErringMesh(points, cells, squares, FILLING, slope=10.0).next_sizes(3.0)
    present = np.sqrt(simplex_volumes(points, cells)[0] / FILLING)
    left, right = (found[inside] / present for inside in (points[:, 0] < 0.4, points[:, 0] > 0.6))
    assert np.ptp(left) < 1e-9 and np.ptp(right) < 1e-9
    assert right[0] / left[0] == pytest.approx(4.0 ** (1.0 / 4.0), rel=1e-9)


def test_sizes_grow_gently():
    points, cells = grid(16)
    squares = np.zeros(len(cells))
    squares[np.argmin(np.linalg.norm(points[cells].mean(axis=1), axis=1))] = 1.0
    sizes = {
        slope: ErringMesh(points, cells, squares, FILLING, slope).next_sizes(4.0)
        for slope in (0.1, 10.0)
    }
    for a in range(3):
        first, second = cells[:, a], cells[:, a - 1]
        distance = np.linalg.norm(points[first] - points[second], axis=1)
        rise = np.abs(sizes[0.1][first] - sizes[0.1][second])
        assert np.all(rise <= 0.1 * distance * (1.0 + 1e-9))
    assert sizes[0.1].mean() < sizes[10.0].mean()


def test_without_errors_sizes_stay_and_no_cell_is_cut_too_often():
    points, cells = grid(8)
    present = np.sqrt(simplex_volumes(points, cells)[0] / FILLING)
    none = ErringMesh(points, cells, np.zeros(len(cells)), FILLING, 0.4).next_sizes(2.0)
    most = ErringMesh(points, cells, np.ones(len(cells)), FILLING, 0.4).next_sizes(100.0)
    np.testing.assert_allclose(none, present, rtol=1e-9)
    np.testing.assert_allclose(most, SMALLEST * present, rtol=1e-9)
