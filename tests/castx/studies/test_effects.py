"""Effects of models whose effects are known."""

import numpy as np
import pytest
from scipy.stats import sobol_indices

from castx.studies.effects import elementary, lines, variance_shares
from castx.studies.sampling import latin_hypercube, morris_paths, saltelli_points

pytestmark = pytest.mark.serial

WEIGHTS = np.array([1.0, 2.0, -0.5])


def test_lines_of_a_straight_model():
    points = latin_hypercube(3, 12, 0)
    result = 7.0 + points @ WEIGHTS
    result[3] = np.nan
    found = lines(points, result)
    np.testing.assert_allclose(found.slopes, WEIGHTS, rtol=1e-10)
    assert found.explained == pytest.approx(1.0)


def test_lines_of_a_parabola_explain_nothing():
    points = np.linspace(0.0, 1.0, 101)[:, None]
    found = lines(points, (points[:, 0] - 0.5) ** 2)
    assert abs(found.slopes[0]) < 1e-12 and abs(found.explained) < 1e-12


def test_lines_need_runs():
    points = latin_hypercube(3, 4, 0)
    assert lines(points, points @ WEIGHTS) is None
    same = np.ones((9, 2)) * np.linspace(0, 1, 9)[:, None]
    assert lines(same, same[:, 0]) is None


def test_elementary_effects_of_a_straight_model_and_of_a_product():
    points = morris_paths(3, 20, 3)
    found = elementary(points, points @ WEIGHTS)
    np.testing.assert_allclose(found.mean, WEIGHTS, rtol=1e-10)
    np.testing.assert_allclose(found.strength, np.abs(WEIGHTS), rtol=1e-10)
    np.testing.assert_allclose(found.spread, 0.0, atol=1e-10)
    product = elementary(points, points[:, 0] * points[:, 1])
    assert product.spread[0] > 0.2 and product.spread[2] == 0.0 and product.strength[2] == 0.0


def test_a_failed_run_takes_its_two_steps_along():
    points = morris_paths(1, 2, 0)
    result = points[:, 0] * np.array([1.0, 1.0, 3.0, 3.0])
    result[0] = np.nan
    assert elementary(points, result).mean[0] == pytest.approx(3.0)
    assert np.isnan(elementary(points, np.full(4, np.nan)).mean[0])


def test_variance_shares_of_a_straight_model():
    """Y = X1 + 2 X2 + 0.5 X3 of equal widths: 0.190476, 0.761905, 0.047619, first and total."""
    points = saltelli_points(3, 2048, 1)
    found = variance_shares(points, points @ np.array([1.0, 2.0, 0.5]))
    exact = np.array([1.0, 4.0, 0.25]) / 5.25
    np.testing.assert_allclose(found.first, exact, atol=0.005)
    np.testing.assert_allclose(found.total, exact, atol=0.005)


def test_variance_shares_are_those_of_scipy():
    points = saltelli_points(2, 64, 4)
    result = np.sin(3.0 * points[:, 0]) * (0.2 + points[:, 1]) ** 2
    found = variance_shares(points, result)
    first, second, mixed = result[:64], result[64:128], result[128:].reshape(2, 64)
    given = {"f_A": first[None], "f_B": second[None], "f_AB": mixed[:, None]}
    asked = sobol_indices(func=given, n=64)
    np.testing.assert_allclose(found.first, asked.first_order.ravel(), rtol=1e-6)
    np.testing.assert_allclose(found.total, asked.total_order.ravel(), rtol=1e-6)


def test_a_draw_of_which_a_run_has_failed_is_left_out():
    points = saltelli_points(2, 8, 4)
    result = points[:, 0] + points[:, 1] ** 2
    kept = np.delete(result.reshape(4, 8), 5, axis=1).ravel()
    result[2 * 8 + 5] = np.nan
    found, wanted = variance_shares(points, result), variance_shares(points, kept)
    assert found.draws == 7
    np.testing.assert_array_equal(found.first, wanted.first)


def test_what_does_not_vary_has_no_shares():
    points = saltelli_points(2, 8, 4)
    assert variance_shares(points, np.full(len(points), 3.0)) is None
