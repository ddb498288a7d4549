"""Descents within bounds."""

import numpy as np
import pytest

from castx.errors import ConvergenceError
from castx.foundry.identification.descent import bounded_step, descend

pytestmark = pytest.mark.serial

FREE = np.full(2, -np.inf), np.full(2, np.inf)


def valley(point):
    """Rosenbrock's valley, whose least is at (1, 1)."""
    return np.array([10.0 * (point[1] - point[0] ** 2), 1.0 - point[0]])


def slopes(point):
    return np.array([[-20.0 * point[0], 10.0], [-1.0, 0.0]])


def test_the_end_of_the_valley():
    found = descend(valley, slopes, np.array([-1.2, 1.0]), FREE, 60)
    deviations = np.sqrt(np.diag(np.linalg.inv(found.slopes.T @ found.slopes)))
    assert np.all(np.abs(found.point - 1.0) < 0.02 * deviations)


def test_a_bound_ends_it():
    """With x at most 0.5 the least is (0.5, 0.25)."""
    bounds = np.full(2, -np.inf), np.array([0.5, np.inf])
    found = descend(valley, slopes, np.array([-1.2, 1.0]), bounds, 60)
    assert found.point == pytest.approx([0.5, 0.25], abs=0.02)
    assert found.point[0] == 0.5


def test_bounded_steps_pull_only_against_their_bounds():
    """The conditions of Karush, Kuhn and Tucker, of steps of which most meet a bound."""
    random = np.random.default_rng(5)
    held = 0
    for _ in range(40):
        matrix, target = random.normal(size=(8, 3)), random.normal(size=8)
        low, high = -random.random(3), random.random(3)
        curvature, gradient = matrix.T @ matrix, 3.0 * matrix.T @ target
        step = bounded_step(curvature, gradient, (low, high))
        pull = gradient + curvature @ step
        free = (step > low + 1e-12) & (step < high - 1e-12)
        np.testing.assert_allclose(pull[free], 0.0, atol=1e-9)
        assert np.all(pull[step <= low + 1e-12] >= -1e-9)
        assert np.all(pull[step >= high - 1e-12] <= 1e-9)
        held += np.sum(~free)
    assert 20 < held < 100


def test_failed_points_are_refused():
    seen = []

    def fragile(point):
        seen.append(point.copy())
        return np.full(2, np.inf) if point[0] > 1.5 else valley(point)

    found = descend(fragile, slopes, np.array([0.0, 4.0]), FREE, 60)
    assert found.point == pytest.approx([1.0, 1.0], abs=0.05)


def test_noise_of_the_model_ends_it():
    """A model that is rough below a hundredth of the posterior deviation settles all the same."""
    random = np.random.default_rng(0)

    def rough(point):
        return valley(point) + np.array([0.3, 1e-2]) + 1e-3 * random.normal(size=2)

    assert descend(rough, slopes, np.array([0.9, 0.8]), FREE, 60).point[0] == pytest.approx(
        1, abs=0.2
    )


def test_what_does_not_settle_or_tell_is_refused():
    with pytest.raises(ConvergenceError, match="not settled"):
        descend(valley, slopes, np.array([-1.2, 1.0]), FREE, 3)
    with pytest.raises(ValueError, match="do not tell all parameters apart"):
        descend(lambda p: np.array([p.sum()]), lambda p: np.ones((1, 2)), np.ones(2), FREE, 9)


def test_steps_go_no_farther_than_their_reach():
    seen = []

    def watched(point):
        seen.append(point.copy())
        return valley(point)

    reach = np.array([0.1, np.inf])
    found = descend(watched, slopes, np.array([-1.2, 1.0]), FREE, 100, reach)
    assert np.max(np.abs(np.diff(np.array(seen)[:, 0]))) < 0.2 + 1e-12
    assert abs(seen[1][0] - seen[0][0]) <= 0.1 + 1e-12
    assert found.point == pytest.approx([1.0, 1.0], abs=0.05)
