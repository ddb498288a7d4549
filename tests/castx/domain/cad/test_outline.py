"""The outline of a section: what lies nearest to a place, and where it is deepest."""

import numpy as np
import pytest

from castx.domain.cad.outline import Outline

pytestmark = pytest.mark.serial


def grid(cells):
    """Return the triangles of unit squares whose lower corners are given."""
    found = []
    for x, y in cells:
        a, b, c, d = ((x, y, 0), (x + 1, y, 0), (x + 1, y + 1, 0), (x, y + 1, 0))
        found += [(a, b, c), (c, d, a)]
    return np.array(found, dtype=float)


SQUARE = [(x, y) for x in range(4) for y in range(4)]
ANGLE = [(x, y) for x, y in [(x, y) for x in range(9) for y in range(9)] if x < 3 or y < 3]


@pytest.mark.parametrize("cells, length", [(SQUARE, 16), (ANGLE, 36)])
def test_edges_of_one_triangle_alone_are_the_outline(cells, length):
    segments = Outline.of(grid(cells)).segments
    assert np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum() == pytest.approx(length)


def test_the_nearest_point_lies_on_the_outline():
    outline = Outline.of(grid(SQUARE))
    for place, nearest in (((9, 2.3), (4, 2.3)), ((9, 9), (4, 4)), ((1.5, 0.5), (1.5, 0))):
        assert outline.nearest(np.array([*place, 0.0])) == pytest.approx([*nearest, 0.0])


def test_the_core_is_the_middle_where_that_is_deepest():
    middle = np.array([2.0, 2.0, 0.0])
    assert Outline.of(grid(SQUARE)).core(middle) == pytest.approx(middle)
    # the middle of an L lies outside; the root of its legs is deepest
    core = Outline.of(grid(ANGLE)).core(np.array([4.5, 4.5, 0.0]))
    assert (core[:2] < 2.5).all() and (core[:2] > 1.3).all()
