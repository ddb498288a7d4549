"""Covariance of fitted parameters: formulas of straight lines, a prior, and coverage by draws."""

import numpy as np
import pytest

from castx.foundry.identification.covariance import (
    band,
    correlation,
    deviations,
    posterior,
    reduced_chi_square,
    widened,
)
from castx.foundry.identification.lumped import LumpedCooling

pytestmark = pytest.mark.serial


def test_a_straight_line():
    x = np.array([0.0, 1.0, 2.0, 5.0])
    found = posterior(np.column_stack([np.ones(4), x]), np.array(0.5))
    spread = np.sum((x - x.mean()) ** 2)
    assert found[1, 1] == pytest.approx(0.25 / spread, rel=1e-12)
    assert found[0, 0] == pytest.approx(0.25 * (0.25 + x.mean() ** 2 / spread), rel=1e-12)
    expected = -x.mean() / np.sqrt(np.mean(x**2))
    assert correlation(found)[0, 1] == pytest.approx(expected, rel=1e-12)


def test_a_prior_adds_what_is_known():
    found = posterior(np.ones((4, 1)), np.full(4, 2.0), np.array([[1.0]]))
    assert deviations(found)[0] == pytest.approx(np.sqrt(0.5), rel=1e-12)


def test_parameters_that_no_sample_tells_apart_are_refused():
    same = np.ones((5, 2))
    with pytest.raises(ValueError, match="do not tell all parameters apart"):
        posterior(same, np.array(1.0))
    assert np.isfinite(posterior(same, np.array(1.0), np.eye(2))).all()


def test_bands_of_95_percent_hit_as_often_as_they_say():
    """2000 fits of a cooling body by Gauss and Newton, each with noise of its own."""
    random = np.random.default_rng(20261123)
    time = np.arange(1.0, 61.0)
    body = LumpedCooling(2.6e4, 500.0, 600.0, 100.0)
    hits = 0
    for _ in range(2000):
        measured = body.temperature(time) + random.normal(size=time.size)
        log = np.log(480.0)
        for _ in range(4):
            now = LumpedCooling(2.6e4, float(np.exp(log)), 600.0, 100.0)
            changes = now.sensitivity(time)[:, 0]
            log += changes @ (measured - now.temperature(time)) / (changes @ changes)
        band = 1.96 * deviations(now.covariance(time, 1.0))[0]
        hits += abs(log - np.log(500.0)) < band
    assert 0.94 < hits / 2000 < 0.96


def test_smoothness_adds_what_is_known():
    """Two knots seen with deviations 2 and 2/3, their difference known to γ = 0.5."""
    changes = np.array([[1.0, 0.0], [0.0, 3.0]])
    rough = np.array([[1.0, -1.0]]) / 0.5
    found = posterior(changes, np.array(2.0), smoothness=rough)
    a, b, g = 0.25, 2.25, 4.0
    determinant = (a + g) * (b + g) - g**2
    np.testing.assert_allclose(
        found, np.array([[b + g, g], [g, a + g]]) / determinant, rtol=1e-12
    )
    np.testing.assert_allclose(posterior(changes, np.array(2.0)), np.diag([4.0, 4.0 / 9.0]))


def test_degrees_of_freedom_count_what_samples_tell():
    """One mean of four samples: three are left; with a prior as strong, three and a half."""
    residuals = np.array([1.0, -1.0, 2.0, 0.0])
    ones = np.ones((4, 1))
    free = posterior(ones, np.array(2.0))
    assert reduced_chi_square(residuals, np.array(2.0), ones, free) == pytest.approx(1.5 / 3.0)
    held = posterior(ones, np.array(2.0), np.array([[1.0]]))
    assert reduced_chi_square(residuals, np.array(2.0), ones, held) == pytest.approx(1.5 / 3.5)
    one = ones[:1]
    with pytest.raises(ValueError, match="not more samples than parameters"):
        reduced_chi_square(np.zeros(1), np.array(1.0), one, posterior(one, np.ones(1)))


def test_a_misfit_widens_and_a_lucky_fit_does_not_narrow():
    assert widened(np.eye(2), 2.5)[0, 0] == 2.5
    assert widened(np.eye(2), 0.4)[0, 0] == 1.0


def test_the_band_of_a_line():
    """Of a straight line 1.96 σ √(1/n + (x - x̄)²/Σ(x - x̄)²)."""
    x = np.array([0.0, 1.0, 2.0, 5.0])
    changes = np.column_stack([np.ones(4), x])
    found = band(np.array([[1.0, 3.5]]), posterior(changes, np.array(0.5)))
    spread = np.sum((x - x.mean()) ** 2)
    expected = 1.96 * 0.5 * np.sqrt(0.25 + (3.5 - x.mean()) ** 2 / spread)
    assert found == pytest.approx([expected], rel=1e-12)
