"""Nodes that follow: inside by the mean of their neighbours, outside not at all."""

import numpy as np
import pytest

from castx.errors import MeshError
from castx.handover.following import followed
from tests.castx.handover.made_results import box

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("corners", [3, -4, 4, 8])
def test_other_nodes_follow_between_what_moves_and_what_stays(corners):
    points, cells = box(corners, (6, 6, 4))
    leading = np.flatnonzero(np.abs(points[:, 0]) < 1e-9)
    motion = np.tile([1e-3, 0.0, 0.0], (len(leading), 1))
    places = followed(points, [cells], leading, motion)
    moved = places - points
    np.testing.assert_allclose(moved[leading], motion, atol=1e-15)
    low, high = points.min(axis=0), points.max(axis=0)
    axes = range(2 if abs(corners) < 5 and corners in (3, -4) else 3)
    outer = np.any([np.isclose(points[:, a], low[a]) | np.isclose(points[:, a], high[a])
                    for a in axes], axis=0)  # fmt: skip
    rest = np.setdiff1d(np.flatnonzero(outer), leading)
    np.testing.assert_allclose(moved[rest], 0.0, atol=1e-18)
    inner = moved[~outer, 0]
    assert inner.size and (inner > 0.0).all() and (inner < 1e-3).all()


def test_a_motion_that_turns_cells_over_is_refused():
    points, cells = box(4, (3, 3, 3))
    leading = np.flatnonzero(np.abs(points[:, 0]) < 1e-9)
    with pytest.raises(MeshError, match=r"turns .* cells over"):
        followed(points, [cells], leading, np.tile([0.02, 0.0, 0.0], (len(leading), 1)))
