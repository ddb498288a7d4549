"""Points of the unit cube have the properties by which they are defined."""

import numpy as np
import pytest

from castx.studies.sampling import (
    LEVELS,
    STEP,
    grid,
    latin_hypercube,
    morris_paths,
    saltelli_points,
)

pytestmark = pytest.mark.serial


def test_each_slice_of_a_latin_hypercube_has_one_point():
    points = latin_hypercube(3, 16, 5)
    for column in points.T:
        assert sorted(np.floor(16 * column)) == list(range(16))
    np.testing.assert_array_equal(points, latin_hypercube(3, 16, 5))
    assert not np.array_equal(points, latin_hypercube(3, 16, 6))


def test_a_grid_has_all_combinations():
    points = grid([np.array([0.0, 1.0]), np.array([0.0, 0.5, 1.0])])
    assert points.tolist() == [[0, 0], [0, 0.5], [0, 1], [1, 0], [1, 0.5], [1, 1]]


def test_a_path_moves_each_input_once_between_levels():
    points = morris_paths(4, 25, 1)
    levels = np.round(points * (LEVELS - 1), 12)
    assert np.all(levels == np.round(levels)) and points.min() >= 0.0 and points.max() <= 1.0
    for path in points.reshape(25, 5, 4):
        moved = np.diff(path, axis=0)
        assert np.all(np.sum(moved != 0.0, axis=1) == 1)
        assert sorted(np.argmax(np.abs(moved), axis=1)) == [0, 1, 2, 3]
        np.testing.assert_allclose(np.abs(moved).max(axis=1), STEP)
    assert len(np.unique(levels)) == LEVELS


def test_points_of_saltelli_exchange_one_input_each():
    points = saltelli_points(3, 8, 2).reshape(5, 8, 3)
    first, second = points[0], points[1]
    assert np.all(first != second)
    for k in range(3):
        assert np.array_equal(points[2 + k][:, k], second[:, k])
        others = [j for j in range(3) if j != k]
        assert np.array_equal(points[2 + k][:, others], first[:, others])
