"""Supports hold every rigid motion that planes of symmetry leave, and nothing twice."""

import numpy as np
import pytest

from castx.handover.supports import rigid_motions, supports
from tests.castx.handover.made_results import box

pytestmark = pytest.mark.serial
X, Y, Z = np.eye(3)
OBLIQUE = np.array([1.0, -1.0, 0.0]) / np.sqrt(2.0)


@pytest.mark.parametrize(
    ("model", "planes", "left"),
    [
        ("3d", [], 6),
        ("3d", [(X, 0.0)], 3),
        ("3d", [(X, 0.0), (Y, 0.0)], 1),
        ("3d", [(X, 0.0), (Y, 0.0), (-Z, -0.01)], 0),
        ("plane-strain", [], 3),
        ("plane-stress", [(Y, 0.02)], 1),
        ("plane-strain", [(X, 0.0), (-Y, 0.0)], 0),
        ("axisymmetric", [], 1),
        ("axisymmetric", [(Y, 0.0)], 0),
    ],
)
def test_as_many_as_motions_are_left(model, planes, left):
    points, _ = box(4 if model == "3d" else 3)
    held = supports(points, model, planes)
    assert held.minimal == left
    motions = rigid_motions(points, model)
    rows = np.einsum("ci,cim->cm", held.directions, motions[held.nodes])
    assert np.linalg.matrix_rank(rows, tol=1e-6) == motions.shape[2]
    further = held.nodes[len(held.nodes) - left :]
    assert len(further) == left
    for normal, offset in planes:
        on_it = np.abs(points @ normal - offset) < 1e-9
        assert on_it.sum() == (np.abs(held.directions @ normal) > 0.999).sum() - (
            np.abs(held.directions[len(held.nodes) - left :] @ normal) > 0.999
        ).sum()


def test_an_oblique_plane_leaves_the_same_as_one_along_an_axis():
    points, _ = box(4, sizes=(0.02, 0.02, 0.01))
    held = supports(points, "3d", [(Y, 0.0), (OBLIQUE, 0.0)])
    assert held.minimal == 1
    np.testing.assert_array_equal(held.directions[-1], Z)


def test_reactions_of_planes_are_taken_out_of_the_forces():
    points, _ = box(4, sizes=(0.02, 0.02, 0.01))
    held = supports(points, "3d", [(Y, 0.0), (OBLIQUE, 0.0)])
    forces = np.random.default_rng(2).normal(size=points.shape)
    left = held.without_reactions(forces)
    edge = np.linalg.norm(points[:, :2], axis=1) < 1e-9  # on both planes
    np.testing.assert_allclose(left[edge, :2], 0.0, atol=1e-15)
    np.testing.assert_array_equal(left[edge, 2], forces[edge, 2])
    on_y = (np.abs(points[:, 1]) < 1e-9) & ~edge
    np.testing.assert_array_equal(left[on_y][:, [0, 2]], forces[on_y][:, [0, 2]])
    assert (left[on_y, 1] == 0.0).all()
    inside = (points[:, 1] > 0.005) & (np.abs(points @ OBLIQUE) > 1e-3)
    np.testing.assert_array_equal(left[inside], forces[inside])
