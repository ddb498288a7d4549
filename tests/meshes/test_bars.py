"""Bars along x: which body a cell belongs to, their sides, depths that are refused."""

import numpy as np
import pytest

from castx.meshes.bars import bars, checked_depth, sides

pytestmark = pytest.mark.serial

X = np.array([-0.2, -0.1, 0.0, 0.1])


@pytest.mark.parametrize("cells, intervals", [("quadrilaterals", 3), ("simplices", 4)])
def test_bodies_meet_at_zero_over_width_and_depth(cells, intervals):
    """Triangles need an even number of intervals, so that their pattern mirrors itself."""
    mesh = bars(X, 0.3, 0.3, 0.1, cells)
    middle = mesh.points[mesh.cells].mean(axis=1)
    np.testing.assert_array_equal(mesh.regions, (middle[:, 0] < 0).astype(int))
    for axis in (1, 2):
        places = np.unique(mesh.points[:, axis].round(12))
        np.testing.assert_allclose(places, np.linspace(0.0, 0.3, intervals + 1), atol=1e-12)
    assert bars(X, 0.3, None, 0.1, cells).dimension == 2


def test_sides_lie_in_their_planes():
    points = np.array([[5.0, 0.0, 0.4], [5.0, 0.3, 0.4], [5.0, 0.1, 0.0], [5.0, 0.1, 0.5]])
    found = {name: contains(points) for name, contains in sides(0.3, 0.5, 1e-9)}
    assert list(found) == ["bottom", "top", "back", "front"]
    np.testing.assert_array_equal(np.stack(list(found.values())), np.eye(4, dtype=bool))
    assert [name for name, _ in sides(0.3, None, 1e-9)] == ["bottom", "top"]


def test_a_body_in_space_needs_a_depth():
    assert checked_depth("3d", 0.2) == 0.2 and checked_depth("plane-strain", 0.2) is None
    for depth, text in ((None, 'the model "3d" needs a depth'), (0.0, "depth must be positive")):
        with pytest.raises(ValueError, match=text):
            checked_depth("3d", depth)
