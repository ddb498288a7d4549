"""Estimates in numbers and words."""

import numpy as np
import pytest

from castx.foundry.identification.directions import Direction
from castx.foundry.identification.fit import Unknown, fit
from castx.studies.inverse.estimates import (
    estimates,
    prior_covariance,
    unseen_sentence,
    whiteness_sentence,
)

pytestmark = pytest.mark.serial

X = np.linspace(0.0, 1.0, 40)


def found(unknowns, noise=0.1, seed=1, x=X):
    """Estimates of y = a + b x + 0 c from a = 2, b = 3."""
    measured = 2.0 + 3.0 * x + noise * np.random.default_rng(seed).normal(size=len(x))

    def model(values):
        return values["a"] + values.get("b", 3.0) * x

    one = fit(model, measured, np.array(0.1), unknowns)
    return estimates(
        one, unknowns, ["K"] * len(unknowns), np.full(40, 0.1), None, [("line", one.residuals)]
    )


def test_bands_are_those_of_straight_lines():
    result = found([Unknown("a", 1.0, 0.1), Unknown("b", 1.0, 0.1)])
    a, b = result.estimates
    columns = np.column_stack([np.ones(40), X])
    exact = 0.1 * np.sqrt(np.diag(np.linalg.inv(columns.T @ columns)))
    factor = np.sqrt(max(1.0, result.fit.chi_square))
    assert [a.deviation, b.deviation] == pytest.approx(list(factor * exact), rel=1e-6)
    assert a.high - a.value == pytest.approx(1.96 * a.deviation)
    assert a.low < 2.0 < a.high and b.low < 3.0 < b.high and a.unit == "K"
    assert result.unseen == [] and result.remarks == []


def test_a_band_of_a_logarithm_is_a_factor():
    (a,) = found([Unknown("a", 1.0, 0.01, positive=True)]).estimates
    assert a.logarithmic and a.high / a.value == pytest.approx(a.value / a.low)
    assert np.log(a.high / a.value) == pytest.approx(1.96 * a.deviation)


def test_what_no_sample_tells_is_named():
    result = found([Unknown("a", 1.0, 0.1), Unknown("c", 5.0, 0.1, deviation=2.0)])
    assert result.estimates[1].deviation == pytest.approx(2.0)
    (text,) = result.unseen
    assert "hardly see c:" in text and "100 %" in text


def test_a_large_misfit_a_bound_and_a_correlation_are_told():
    unknowns = [Unknown("a", 1.0, 0.1, high=1.5), Unknown("b", 1.0, 0.1)]
    (text,) = (t for t in found(unknowns).remarks if "bound" in t)
    assert "A bound holds a" in text
    assert any("χ²_r is" in t for t in found([Unknown("a", 1.0, 0.1)], noise=0.5).remarks)
    far = [Unknown("a", 1.0, 0.1), Unknown("b", 1.0, 0.1)]
    distant = found(far, x=50.0 + X).remarks
    assert any("a and b are told apart badly" in t for t in distant)


def test_what_is_known_before():
    unknowns = [
        Unknown("a", 2.0, 0.1, positive=True),
        Unknown("b", 2.0, 0.1, deviation=0.5),
        Unknown("c", -4.0, 0.1),
        Unknown("d", 0.0, 0.1, low=-1.0, high=5.0),
    ]
    assert np.diag(prior_covariance(unknowns, None)) == pytest.approx([9.0, 0.25, 16.0, 9.0])
    smooth = np.array([[0.0, 2.0, 0.0, 0.0]])
    assert prior_covariance(unknowns, smooth)[1, 1] == pytest.approx(1.0 / (4.0 + 4.0))


def test_whiteness_in_words():
    random = np.random.default_rng(0)
    assert whiteness_sentence("near", random.normal(size=200)).endswith("noise.")
    assert "not what the model lacks" in whiteness_sentence("near", np.sin(X))
    assert "too few samples" in whiteness_sentence("near", np.ones(5))


def test_directions_in_words():
    one = Direction(0.75, np.array([0.6, 0.8]), ("b", "a"))
    assert "see b with a together: its" in unseen_sentence(one) and "80 %" in unseen_sentence(one)
