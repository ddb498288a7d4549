"""Ensembles: exact of straight lines, near the descent of a cooling body, with runs that fail."""

import numpy as np
import pytest

from castx.errors import ConvergenceError
from castx.foundry.identification.covariance import deviations, posterior
from castx.foundry.identification.ensemble import assimilate
from castx.foundry.identification.fit import Unknown, fit
from castx.foundry.identification.lumped import LumpedCooling

pytestmark = pytest.mark.serial

X = np.linspace(-1.0, 2.0, 12)
LINE = [Unknown("a", 0.0, 0.1, 2.0), Unknown("b", 1.0, 0.1, 3.0)]
PRIOR = np.diag([4.0, 9.0])


def lines(several):
    return [v["a"] + v["b"] * X for v in several]


def test_a_line_in_a_large_ensemble():
    measured = 3.0 - 2.0 * X + 0.5 * np.random.default_rng(1).normal(size=12)
    found = assimilate(lines, measured, np.array(0.5), LINE, PRIOR, members=4000, rounds=2)
    changes = np.column_stack([np.ones(12), X])
    exact = posterior(changes, np.array(0.5), PRIOR)
    known = np.linalg.inv(PRIOR) @ np.array([0.0, 1.0])
    mean = exact @ (changes.T @ measured / 0.25 + known)
    assert np.all(np.abs(found.fitted - mean) < 0.1 * deviations(exact))
    np.testing.assert_allclose(deviations(found.covariance), deviations(exact), rtol=0.05)
    np.testing.assert_allclose(found.sensitivity, changes, atol=1e-8)


def test_a_cooling_body_as_the_descent_has_it():
    time = np.arange(1.0, 61.0)
    true = LumpedCooling(2.6e4, 500.0, 600.0, 100.0).temperature(time)
    measured = true + np.random.default_rng(2).normal(size=60)
    unknowns = [Unknown("h", 900.0, 0.01, 1.0, positive=True)]

    def model(values):
        return LumpedCooling(2.6e4, values["h"], 600.0, 100.0).temperature(time)

    lm = fit(model, measured, np.array(1.0), unknowns)
    found = assimilate(
        lambda several: [None if v["h"] > 3000.0 else model(v) for v in several],
        measured, np.array(1.0), unknowns, np.eye(1), members=48, rounds=8,
    )  # fmt: skip
    assert abs(found.fitted - lm.fitted)[0] < 2.0 * deviations(lm.covariance)[0]
    assert 0.5 < deviations(found.covariance)[0] / deviations(lm.covariance)[0] < 2.0


def test_bounds_hold_members():
    bounded = [Unknown("a", 0.0, 0.1, 2.0, low=-1.0, high=1.0), LINE[1]]
    seen = []

    def watched(several):
        seen.extend(v["a"] for v in several)
        return lines(several)

    assimilate(watched, 3.0 - 2.0 * X, np.array(0.5), bounded, PRIOR)
    assert min(seen) == -1.0 and max(seen) == 1.0


def test_too_few_are_refused():
    with pytest.raises(ConvergenceError, match="only 0 of 32 runs"):
        assimilate(lambda s: [None] * len(s), X, np.array(1.0), LINE, PRIOR)
    with pytest.raises(ValueError, match="at least 4 members"):
        assimilate(lines, X, np.array(1.0), LINE, PRIOR, members=3)
