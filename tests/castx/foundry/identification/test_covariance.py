"""Covariance of fitted parameters: formulas of straight lines, a prior, and coverage by draws."""

import numpy as np
import pytest

from castx.foundry.identification.covariance import correlation, deviations, posterior
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
