"""The statistic of Ljung and Box by hand, its limit, how often noise fails, and what it finds."""

import numpy as np
import pytest

from castx.foundry.identification.whiteness import lacking, limit, ljung_box

pytestmark = pytest.mark.serial


def test_the_statistic_by_hand():
    """Of 1, 2, 0, -1: ρ_1 = 1/3, ρ_2 = -1/3, Q = 24 (1/27 + 1/18) = 20/9."""
    assert ljung_box(np.array([1.0, 2.0, 0.0, -1.0]), lags=2) == pytest.approx(20 / 9, rel=1e-14)


def test_alternating_residuals():
    """ρ_k = (-1)^k (n - k)/n, so Q = (n + 2)/n Σ (n - k)."""
    r = (-1.0) ** np.arange(20)
    assert ljung_box(r) == pytest.approx(22 / 20 * sum(range(10, 20)), rel=1e-13)


def test_the_limit_of_ten_lags():
    assert limit() == pytest.approx(18.307, abs=5e-4)
    assert limit(1) == pytest.approx(1.959964**2, rel=1e-6)
    assert limit(10, 0.01) == pytest.approx(23.209, abs=5e-4)


def test_noise_fails_as_often_as_said():
    random = np.random.default_rng(20261123)
    draws = random.normal(size=(4000, 400))
    share = np.mean([ljung_box(row) > limit() for row in draws])
    assert 0.04 < share < 0.065
    assert np.mean([ljung_box(row) for row in draws]) == pytest.approx(10.0, rel=0.03)


def test_a_drift_and_a_constant_error_are_no_noise():
    random = np.random.default_rng(7)
    noise = random.normal(size=(3, 120))
    noise[1] += np.sin(np.linspace(0.0, 6.0, 120))
    noise[2] += 1.0
    sentences = lacking(noise, ["A", "B", "C"])
    assert [sentence[0] for sentence in sentences] == ["B", "C"]
    assert all("noise is not what the model lacks" in sentence for sentence in sentences)
    q = ljung_box(noise[1])
    assert f"(Ljung-Box {q:.1f}, limit 18.3)" in sentences[0]
    assert lacking(noise[:1], ["A"], lags=5) == ()


def test_too_few_samples_are_refused():
    for residuals in (np.ones(10), np.zeros(50)):
        with pytest.raises(ValueError, match="needs more samples"):
            ljung_box(residuals)
