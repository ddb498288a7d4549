"""Rigid motion, deviation, allowance and compensation of shapes of which all is known."""

import numpy as np
import pytest

from castx.foundry.distortion import allowance, best_fit, compensated, normal_deviation

pytestmark = pytest.mark.serial

RANDOM = np.random.default_rng(7)
CONTRACTION = 25.5e-6 * 537.0


def rotation(size):
    turn = np.linalg.qr(RANDOM.normal(size=(size, size)))[0]
    return turn * np.where(np.arange(size) == 0, np.sign(np.linalg.det(turn)), 1.0)


@pytest.mark.parametrize("size", [2, 3])
def test_a_rigid_motion_is_removed_whole(size):
    nominal, areas = RANDOM.normal(size=(40, size)), RANDOM.uniform(0.1, 1.0, 40)
    turn, shift = rotation(size), RANDOM.normal(size=size)
    motion = best_fit(nominal, nominal @ turn.T + shift, areas)
    np.testing.assert_allclose(motion.rotation, turn, atol=1e-12)
    np.testing.assert_allclose(motion.removed(nominal @ turn.T + shift), nominal, atol=1e-12)


def test_a_mirror_image_is_not_taken_for_a_motion():
    nominal = RANDOM.normal(size=(40, 3))
    motion = best_fit(nominal, nominal * [-1.0, 1.0, 1.0], np.ones(40))
    assert np.linalg.det(motion.rotation) == pytest.approx(1.0)


def test_a_free_sphere_shrinks_alike_everywhere():
    normals = RANDOM.normal(size=(500, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.vstack([normals, -normals])
    nominal, turn = 0.05 * normals, rotation(3)
    places = (1.0 - CONTRACTION) * nominal @ turn.T + [0.3, -0.1, 0.2]
    motion = best_fit(nominal, places, np.ones(len(nominal)))
    found = normal_deviation(nominal, motion.removed(places), normals)
    assert pytest.approx(0.0136935, rel=1e-14) == CONTRACTION
    np.testing.assert_allclose(found, -0.684675e-3, rtol=1e-10)


def test_a_free_contraction_leaves_its_share_of_the_distance_to_the_centre():
    nominal, areas = RANDOM.uniform(size=(60, 3)), RANDOM.uniform(0.1, 1.0, 60)
    normals = RANDOM.normal(size=(60, 3))
    middle = areas @ nominal / areas.sum()
    places = nominal - 0.011 * (nominal - [1.0, 2.0, 3.0])
    found = normal_deviation(nominal, best_fit(nominal, places, areas).removed(places), normals)
    exact = -0.011 * np.einsum("ij,ij->i", nominal - middle, normals)
    np.testing.assert_allclose(found, exact, atol=1e-13)


def test_an_axisymmetric_body_moves_along_its_axis_only():
    nominal = np.array([[0.01, 0.0], [0.02, 0.0], [0.02, 0.05]])
    places = nominal + np.array([1e-4, 3e-4])
    motion = best_fit(nominal, places, np.ones(3), axisymmetric=True)
    np.testing.assert_allclose(motion.removed(places) - nominal, [[1e-4, 0.0]] * 3, atol=1e-16)


def shrunk(nominal, places, normals, areas=None, axisymmetric=False):
    weights = np.ones(len(nominal)) if areas is None else areas
    fitted = best_fit(nominal, places, weights, axisymmetric).removed(places)
    return allowance(nominal, fitted, normals, weights, axisymmetric)


def box(*sizes):
    """Return points of the faces of a box round the origin, their normals and their faces.

    Faces have numbers, across the axes in turn, each low and high.
    """
    points, normals, numbers = [], [], []
    for axis, size in enumerate(sizes):
        for side in (-0.5, 0.5):
            found = RANDOM.uniform(-0.5, 0.5, (40, len(sizes))) * sizes
            found[:, axis] = side * size
            points.append(found)
            normals.append(np.tile(np.sign(side) * np.eye(len(sizes))[axis], (40, 1)))
            numbers.append(np.full(40, len(numbers)))
    return np.concatenate(points), np.concatenate(normals), np.concatenate(numbers)


def test_the_allowance_has_a_value_for_each_direction():
    nominal, normals, _ = box(0.3, 0.2, 0.1)
    areas = RANDOM.uniform(0.1, 1.0, len(nominal))
    turn, shift = rotation(3), RANDOM.normal(size=3)
    places = nominal * [0.99, 0.985, 1.002] @ turn.T + shift
    found = shrunk(nominal, places, normals, areas)
    np.testing.assert_allclose(found, [0.01, 0.015, -0.002], rtol=1e-9)


def test_what_slid_along_a_wall_has_not_shrunk():
    """Walls of a box went down by the square of their height, as metal that feeds itself does."""
    nominal, normals, _ = box(0.3, 0.2, 0.1)
    places = nominal * [0.99, 0.985, 0.98]
    places[:, 2] -= np.where(normals[:, 2] == 0.0, 0.3 * (nominal[:, 2] + 0.05) ** 2, 0.0)
    found = shrunk(nominal, places, normals)
    np.testing.assert_allclose(found, [0.01, 0.015, 0.02], rtol=1e-4)


@pytest.mark.parametrize("draught", [0.0, 0.03])
def test_nothing_is_known_along_an_axis_across_which_no_faces_lie_apart(draught):
    """A box without its top: its bottom alone lies across its height, walls but for a draught."""
    nominal, normals, faces = box(0.3, 0.2, 0.1)
    open_box = faces < 5
    nominal, normals = nominal[open_box], normals[open_box]
    normals[faces[open_box] < 4, 2] = -draught
    found = shrunk(nominal, 0.99 * nominal, normals)
    np.testing.assert_allclose(found[:2], 0.01, rtol=1e-6)
    assert np.isnan(found[2])
    shelf = np.array([[x, y, 0.02] for x in (-0.1, 0.0, 0.1) for y in (-0.05, 0.0, 0.05)])
    nominal = np.concatenate([nominal, shelf])
    normals = np.concatenate([normals, np.tile([0.0, 0.0, 1.0], (9, 1))])
    np.testing.assert_allclose(shrunk(nominal, 0.99 * nominal, normals), 0.01, rtol=1e-6)


def test_a_bent_plate_shrinks_by_its_contraction_only():
    """It sags by 0.7 mm, of a thickness of 25 mm: its extent across the plane grows by 2.7 %."""
    along, across = np.linspace(-0.1, 0.1, 21), np.linspace(-0.0125, 0.0125, 5)
    faces = [np.column_stack([along, np.full(21, y)]) for y in across[[0, -1]]]
    ends = [np.column_stack([np.full(5, x), across]) for x in along[[0, -1]]]
    nominal = np.concatenate([*faces, *ends])
    normals = np.repeat([[0.0, -1.0], [0.0, 1.0], [-1.0, 0.0], [1.0, 0.0]], [21, 21, 5, 5], axis=0)
    (x, y), curvature = nominal.T, 2 * 0.7e-3 / 0.1**2
    bent = np.column_stack([-curvature * x * y, 0.5 * curvature * x**2])
    places = (1.0 - 1.2e-3) * nominal + bent
    np.testing.assert_allclose(shrunk(nominal, places, normals), [1.2e-3] * 2, rtol=1e-2)


def test_a_ring_shrinks_by_its_radii():
    """Its wall grows thicker by 1 % while its mean radius falls by 1 %."""
    nominal = np.array([[0.09, 0.02], [0.11, 0.03], [0.1, 0.05], [0.1, 0.0]])
    normals = np.array([[-1.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    radii = 0.99 * 0.1 + 1.01 * (nominal[:, 0] - 0.1)
    places = np.column_stack([radii, 0.98 * nominal[:, 1]])
    faces = nominal[:2, 0]
    expected = 1.0 - np.sum(radii[:2] * faces) / np.sum(faces**2)
    assert expected == pytest.approx(0.01, abs=3e-4)
    found = shrunk(nominal, places, normals, axisymmetric=True)
    np.testing.assert_allclose(found, [expected, 0.02], rtol=1e-9)


def test_compensation_leaves_the_square_and_the_cube_of_a_free_contraction():
    nominal = np.array([[1.0, 0.0, 0.0], [0.0, -2.0, 0.5]])
    mould = nominal
    left = []
    for _ in range(2):
        mould = compensated(mould, (1.0 - CONTRACTION) * mould, nominal)
        left.append(((1.0 - CONTRACTION) * mould - nominal)[0, 0])
    np.testing.assert_allclose(left, [-1.87512e-4, -2.56769e-6], rtol=3e-6)
    np.testing.assert_allclose(left, [-(CONTRACTION**2), -(CONTRACTION**3)], rtol=1e-9)
