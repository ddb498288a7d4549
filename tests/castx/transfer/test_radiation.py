"""Radiation of grey surfaces: values, derivative, below absolute zero."""

from __future__ import annotations

import numpy as np
import pytest

from castx.transfer.radiation import (
    STEFAN_BOLTZMANN,
    emission,
    facing_factor,
    radiation_coefficient,
)

pytestmark = pytest.mark.serial


def test_emission_of_a_black_surface():
    # σ·1000⁴ = 5.670374419e-8·1e12 = 56703.74419 W/m²; 4σ·1000³ = 226.81497676 W/m²/K
    power, slope = emission(np.array([726.85]))
    assert power == pytest.approx(56703.74419, rel=1e-12)
    assert slope == pytest.approx(226.81497676, rel=1e-12)
    assert emission(np.array([-273.15]))[0] == 0.0


def test_derivative_by_differences_also_below_absolute_zero():
    temperature, step = np.array([-500.0, -300.0, 20.0, 1500.0]), 1e-3
    rise = (emission(temperature + step)[0] - emission(temperature - step)[0]) / (2 * step)
    np.testing.assert_allclose(emission(temperature)[1], rise, rtol=1e-7)
    assert (np.diff(emission(np.linspace(-600.0, 100.0, 50))[0]) > 0.0).all()


def test_coefficient_is_the_difference_of_emission_over_that_of_temperatures():
    (hot, cold), _ = emission(np.array([900.0, 20.0]))
    assert radiation_coefficient(900.0, 20.0) == pytest.approx((hot - cold) / 880.0, rel=1e-13)
    assert radiation_coefficient(900.0, 900.0) == pytest.approx(
        emission(np.array([900.0]))[1].item(), rel=1e-13
    )


def test_factor_of_facing_surfaces():
    assert facing_factor((1.0, 1.0)) == pytest.approx(1.0)
    assert facing_factor((1.0, 0.35)) == pytest.approx(0.35)
    # many reflections between both: ε₁ε₂ Σ ((1−ε₁)(1−ε₂))ⁿ
    first, second = 0.3, 0.8
    series = sum(first * second * (0.7 * 0.2) ** n for n in range(60))
    assert facing_factor((first, second)) == pytest.approx(series, rel=1e-14)
    planck, boltzmann, light = 6.62607015e-34, 1.380649e-23, 299792458.0
    exact = 2.0 * np.pi**5 * boltzmann**4 / (15.0 * planck**3 * light**2)
    assert STEFAN_BOLTZMANN == pytest.approx(exact, rel=1e-9)
