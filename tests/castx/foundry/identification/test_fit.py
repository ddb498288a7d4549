"""Fits: of straight lines in closed form, of a cooling body, with runs that fail, and coverage."""

import numpy as np
import pytest

from castx.errors import ConvergenceError, UnsettledFit
from castx.foundry.identification.covariance import deviations, posterior
from castx.foundry.identification.fit import Unknown, fit
from castx.foundry.identification.lumped import LumpedCooling
from castx.foundry.identification.smoothness import second_differences

pytestmark = pytest.mark.serial

TIME = np.arange(1.0, 61.0)
TRUE = LumpedCooling(2.6e4, 500.0, 600.0, 100.0)


def cooling(values):
    return LumpedCooling(2.6e4, values["h"], values.get("start", 600.0), 100.0).temperature(TIME)


def noisy(seed, deviation=1.0):
    noise = np.random.default_rng(seed).normal(scale=deviation, size=TIME.size)
    return TRUE.temperature(TIME) + noise


COEFFICIENT = Unknown("h", 2000.0, 0.01, positive=True)


def test_a_cooling_body_without_noise():
    """From four times the coefficient and 20 K off: both are found, with their covariance."""
    start = Unknown("start", 620.0, 0.1)
    found = fit(cooling, TRUE.temperature(TIME), np.array(1.0), [COEFFICIENT, start])
    exact = TRUE.covariance(TIME, 1.0, start_known=False)
    off = np.abs(found.fitted - [np.log(500.0), 600.0])
    assert np.all(off < 0.02 * deviations(exact))
    np.testing.assert_allclose(deviations(found.covariance), deviations(exact), rtol=0.01)
    assert found.values["h"] == pytest.approx(500.0, rel=1e-4)
    assert found.runs < 40


def test_noise_widens_by_what_the_model_lacks():
    """Three times the noise that was said: χ²_r near 9, deviations three times as large."""
    found = fit(cooling, noisy(5, 3.0), np.array(1.0), [COEFFICIENT])
    assert found.chi_square == pytest.approx(9.0, rel=0.3)
    ratio = deviations(found.widened) / deviations(found.covariance)
    assert ratio == pytest.approx(np.sqrt(found.chi_square), rel=1e-12)
    squares = np.sum(found.residuals**2)
    assert found.chi_square == pytest.approx(squares / 59.0, rel=1e-9)
    assert abs(found.residuals.mean()) < 1.0


def test_two_thousand_lines_are_covered():
    """Lines are their own tangents: 95 % bands of both hit 94 to 96 % of 2000 draws."""
    x = np.linspace(-1.0, 2.0, 12)
    random = np.random.default_rng(20261123)
    unknowns = [Unknown("a", 0.0, 0.1), Unknown("b", 1.0, 0.1)]
    hits = np.zeros(2)
    for _ in range(2000):
        measured = 3.0 - 2.0 * x + 0.5 * random.normal(size=12)
        found = fit(lambda v: v["a"] + v["b"] * x, measured, np.array(0.5), unknowns)
        hits += np.abs(found.fitted - [3.0, -2.0]) < 1.96 * deviations(found.covariance)
    assert np.all((hits > 0.94 * 2000) & (hits < 0.96 * 2000))


def test_priors_and_smoothness_count_as_samples_do():
    """A linear model: the least of Φ in closed form."""
    knots = np.array([0.0, 1.0, 3.0, 8.0])
    changes = np.random.default_rng(2).normal(size=(6, 4))
    measured = changes @ np.array([1.0, 2.0, 0.0, -1.0]) + 0.3
    rough = second_differences(knots) / 0.7
    unknowns = [
        Unknown(name, 0.5, 0.01, deviation)
        for name, deviation in zip("abcd", (0.5, np.inf, 2.0, np.inf), strict=True)
    ]

    def model(values):
        return changes @ np.array([values[name] for name in "abcd"])

    found = fit(model, measured, np.array(0.2), unknowns, rough)
    known = np.diag([1 / 0.25, 0.0, 1 / 4.0, 0.0])
    matrix = changes.T @ changes / 0.04 + known + rough.T @ rough
    exact = np.linalg.solve(matrix, changes.T @ measured / 0.04 + known @ np.full(4, 0.5))
    np.testing.assert_allclose(found.covariance, np.linalg.inv(matrix), rtol=1e-8)
    assert np.all(np.abs(found.fitted - exact) < 0.02 * deviations(found.covariance))
    free = fit(model, measured, np.array(0.2), [Unknown(name, 0.5, 0.01) for name in "abcd"])
    assert np.linalg.norm(free.fitted - exact) > 1e-2


def test_a_run_that_fails_is_a_refused_step():
    """The full step goes far below the coefficients for which the model runs."""
    failed = []

    def fragile(values):
        if not 450.0 < values["h"] < 2001.0:
            failed.append(values["h"])
            raise ConvergenceError("no solution")
        return cooling(values)

    found = fit(fragile, noisy(1), np.array(1.0), [COEFFICIENT])
    assert len(failed) >= 2 and min(failed) < 450.0 and max(failed) > 2001.0
    whole = fit(cooling, noisy(1), np.array(1.0), [COEFFICIENT])
    assert abs(found.fitted - whole.fitted)[0] < 0.04 * deviations(whole.covariance)[0]


def test_a_difference_changes_the_slope():
    wide = fit(cooling, noisy(1), np.array(1.0), [Unknown("h", 2000.0, 0.3, positive=True)])
    fine = fit(cooling, noisy(1), np.array(1.0), [COEFFICIENT])
    assert abs(wide.covariance[0, 0] / fine.covariance[0, 0] - 1.0) > 0.05


def test_what_does_not_settle_or_begin_is_told():
    with pytest.raises(UnsettledFit, match="not settled after"):
        fit(cooling, noisy(1), np.array(1.0), [COEFFICIENT], tries=2)

    def broken(values):
        raise ConvergenceError("no solution at the start")

    with pytest.raises(ConvergenceError, match="at the start"):
        fit(broken, noisy(1), np.array(1.0), [COEFFICIENT])
    twice = [Unknown("a", 0.0, 0.1), Unknown("b", 0.0, 0.1)]
    seen = Unknown("c", 0.0, 0.1)
    with pytest.raises(ValueError, match=r"do not tell all parameters apart, least of all a, b$"):
        fit(lambda v: 1e-3 * (v["a"] + v["b"]) * TIME + v["c"], TIME, np.array(1.0), [seen, *twice])
    with pytest.raises(ValueError, match=r"apart, least of all b$"):
        fit(lambda v: v["a"] * TIME, TIME, np.array(1.0), twice)


def test_the_covariance_is_that_of_all_that_is_known():
    found = fit(cooling, noisy(4), np.array(2.0), [COEFFICIENT])
    again = posterior(found.sensitivity, np.array(2.0))
    np.testing.assert_allclose(found.covariance, again, rtol=1e-12)
