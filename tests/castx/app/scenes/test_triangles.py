"""Polygons become triangles of the same area."""

import numpy as np
import pytest

from castx.app.scenes.triangles import triangulated

pytestmark = pytest.mark.serial


def area(triangles):
    sides = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    return 0.5 * np.linalg.norm(np.cross(*sides), axis=1)


def test_a_quadrilateral_is_two_triangles_behind_each_other():
    quads = np.array(
        [
            [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]],
            [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
        ],
        dtype=float,
    )
    found = triangulated(quads)
    assert found.shape == (4, 3, 3)
    assert area(found).tolist() == [1.0, 1.0, 0.5, 0.5]


def test_triangles_stay_as_they_are():
    one = np.arange(9.0).reshape(1, 3, 3)
    assert np.array_equal(triangulated(one), one)
