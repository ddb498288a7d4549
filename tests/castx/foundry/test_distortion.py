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


def test_the_allowance_has_a_value_for_each_direction():
    nominal = RANDOM.uniform(size=(60, 3))
    areas = RANDOM.uniform(0.1, 1.0, 60)
    turn, shift = rotation(3), RANDOM.normal(size=3)
    found = allowance(nominal, nominal * [0.99, 0.985, 1.002] @ turn.T + shift, areas)
    np.testing.assert_allclose(found, [0.01, 0.015, -0.002], rtol=1e-11)


def test_a_bent_plate_shrinks_by_its_contraction_only():
    """It sags by 0.7 mm, of a thickness of 25 mm: its extent across the plane grows by 2.7 %."""
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-0.1, 0.1, 21), [-0.0125, 0.0125]))
    nominal, curvature = np.column_stack([x, y]), 2 * 0.7e-3 / 0.1**2
    bent = np.column_stack([-curvature * x * y, 0.5 * curvature * x**2])
    places = (1.0 - 1.2e-3) * nominal + bent
    assert 1.0 - np.ptp(places[:, 1]) / 0.025 == pytest.approx(-0.0268, abs=1e-4)
    np.testing.assert_allclose(allowance(nominal, places, np.ones(42)), [1.2e-3] * 2, rtol=1e-2)


def test_a_ring_shrinks_by_its_radii():
    """Its wall grows thicker by 1 % while its mean radius falls by 1 %."""
    nominal = np.array([[0.09, 0.0], [0.11, 0.0], [0.11, 0.05], [0.09, 0.05]])
    radii = 0.99 * 0.1 + 1.01 * (nominal[:, 0] - 0.1)
    found = allowance(nominal, np.column_stack([radii, 0.98 * nominal[:, 1]]), np.ones(4), True)
    shrunk = 1.0 - np.sum(radii * nominal[:, 0]) / np.sum(nominal[:, 0] ** 2)
    assert shrunk == pytest.approx(0.01, abs=3e-4)
    np.testing.assert_allclose(found, [shrunk, 0.02], rtol=1e-9)


def test_compensation_leaves_the_square_and_the_cube_of_a_free_contraction():
    nominal = np.array([[1.0, 0.0, 0.0], [0.0, -2.0, 0.5]])
    mould = nominal
    left = []
    for _ in range(2):
        mould = compensated(mould, (1.0 - CONTRACTION) * mould, nominal)
        left.append(((1.0 - CONTRACTION) * mould - nominal)[0, 0])
    np.testing.assert_allclose(left, [-1.87512e-4, -2.56769e-6], rtol=3e-6)
    np.testing.assert_allclose(left, [-(CONTRACTION**2), -(CONTRACTION**3)], rtol=1e-9)
