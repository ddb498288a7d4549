"""Flatness and roundness of surfaces of which all is known."""

import numpy as np
import pytest
from scipy.optimize import minimize

from castx.foundry.roundness import flatness, roundness

pytestmark = pytest.mark.serial


def test_a_parabola_is_flat_to_an_eighth_of_its_curvature():
    x = np.linspace(-0.1, 0.1, 41)
    curved = np.column_stack([x, 0.5 * 0.3 * x**2])
    assert flatness(curved) == pytest.approx(0.3 * 0.2**2 / 8.0, rel=1e-10)


def test_a_tilted_face_is_flat_and_its_dent_is_not():
    x, y = (axis.ravel() for axis in np.meshgrid(np.linspace(-1, 1, 21), np.linspace(-1, 1, 31)))
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    plane = np.column_stack([x, y, np.zeros_like(x)])
    assert flatness(plane @ turn.T + [1.0, 2.0, 3.0]) == pytest.approx(0.0, abs=1e-14)
    saddle = np.column_stack([x, y, 0.01 * x * y])
    assert flatness(saddle @ turn.T) == pytest.approx(0.02, rel=1e-10)


def test_areas_turn_the_plane():
    points = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 1e-3]])
    assert flatness(points, np.array([1.0, 1.0, 1e-9])) == pytest.approx(1e-3, rel=1e-5)


@pytest.mark.parametrize("measure", [flatness, roundness])
def test_a_point_of_two_areas_counts_as_two_points(measure):
    """Uneven points: the plane and the circle move when one of them counts more."""
    angle = np.array([0.0, 0.7, 1.9, 3.0, 4.4, 5.3])
    radius = np.array([1.0, 1.1, 0.95, 1.2, 0.9, 1.05])
    points = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    areas = np.array([1, 2, 1, 4, 1, 3])
    weighed, repeated = measure(points, 1e-4 * areas), measure(np.repeat(points, areas, axis=0))
    assert weighed == pytest.approx(repeated, rel=1e-7)
    assert weighed != pytest.approx(measure(points), rel=1e-2)


@pytest.mark.parametrize("lobes", [2, 3, 5])
def test_an_oval_bore(lobes):
    angle = np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False)
    radius = 0.05 + 2e-5 * np.cos(lobes * angle)
    bore = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]) + [0.2, -0.1]
    assert roundness(bore) == pytest.approx(4e-5, rel=1e-6)


def test_the_circle_of_an_uneven_arc_is_that_of_its_distances():
    """Points 1 % beyond half of an arc: the centre follows from its stationary sum of squares."""
    angle = np.linspace(0.0, 1.5, 30)
    points = np.column_stack([np.cos(angle), np.sin(angle)]) * (1.0 + 0.01 * (angle > 1.0))[:, None]

    def spread(centre):
        return np.linalg.norm(points - centre, axis=1).var()

    best = minimize(
        spread, [0.0, 0.0], method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-18}
    )
    exact = np.ptp(np.linalg.norm(points - best.x, axis=1))
    assert roundness(points) == pytest.approx(exact, rel=1e-5)
