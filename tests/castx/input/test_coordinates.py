"""Coordinates by name, in the plane and in space."""

import numpy as np
import pytest

from castx.input.coordinates import AXES, coordinate

pytestmark = pytest.mark.serial

PLANE = [[0.0, 1.0], [0.5, 2.0]]
SPACE = [[3.0, 4.0, 1.0], [0.0, -0.5, 2.0]]


@pytest.mark.parametrize(
    "axis, in_plane, in_space",
    [
        ("x", [0.0, 0.5], [3.0, 0.0]),
        ("r", [0.0, 0.5], [5.0, 0.5]),
        ("y", [1.0, 2.0], [4.0, -0.5]),
        ("z", [1.0, 2.0], [1.0, 2.0]),
    ],
)
def test_each_axis_in_plane_and_space(axis, in_plane, in_space):
    np.testing.assert_allclose(coordinate(PLANE, axis), in_plane, rtol=1e-15)
    np.testing.assert_allclose(coordinate(SPACE, axis), in_space, rtol=1e-15)


@pytest.mark.parametrize("axis", AXES)
def test_no_points_have_no_coordinates(axis):
    assert coordinate(np.empty((0, 3)), axis).shape == (0,)
