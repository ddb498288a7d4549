"""Overstress from a rate that is no power of the stress: hyperbolic sine, over steps and scales."""

from __future__ import annotations

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.materials.rules.overstress import RateOverstress

pytestmark = pytest.mark.serial

STRESS_SCALE, LOG_COEFFICIENT = np.array([10e6, 40e6]), np.array([-9.0, -20.0])
STEP = 0.25


def stress(
    log_rate: FloatArray, scale: FloatArray, coefficient: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return f of ε̇ = exp(coefficient) sinh(f/scale), and df/d(ln ε̇)."""
    sinh = np.exp(log_rate - coefficient)
    return scale * np.arcsinh(sinh), scale * sinh / np.sqrt(1 + sinh**2)


def log_rate(f: FloatArray, scale: FloatArray, coefficient: FloatArray) -> FloatArray:
    return coefficient + np.log(np.sinh(f / scale))


V = RateOverstress.over_step(stress, log_rate, (STRESS_SCALE, LOG_COEFFICIENT), STEP)
F = np.array([25e6, 7e6])
INCREMENT = STEP * np.exp(LOG_COEFFICIENT) * np.sinh(F / STRESS_SCALE)


def test_the_overstress_of_what_flows_in_a_step() -> None:
    np.testing.assert_allclose(V(INCREMENT), F, rtol=1e-12)
    np.testing.assert_allclose(np.exp(V.logarithm(F)), INCREMENT, rtol=1e-12)
    assert V(np.zeros(2)).tolist() == [0.0, 0.0]
    assert V.curved.all() and not V.modulus.any()


def test_the_slope_by_differences() -> None:
    y, h = np.log(INCREMENT), 1e-5
    difference = (V.evaluate(y + h)[0] - V.evaluate(y - h)[0]) / (2 * h)
    np.testing.assert_allclose(V.evaluate(y)[1], difference, rtol=1e-8)


def test_scales_and_half() -> None:
    unit, logarithm = np.array([3e6, 9e7]), np.array([-4.0, 2.0])
    scaled = V.scaled(unit, logarithm)
    np.testing.assert_allclose(scaled(INCREMENT / np.exp(logarithm)), F / unit, rtol=1e-12)
    again = scaled.scaled(np.array([0.5, 2.0]), np.array([1.0, 1.0]))
    np.testing.assert_allclose(again(INCREMENT / np.exp(logarithm + 1)), F / unit * [2, 0.5])
    np.testing.assert_allclose(scaled(np.exp(scaled.logarithm_of_half())), 0.5, rtol=1e-12)


def test_some_points() -> None:
    second = V.scaled(np.array([3e6, 9e7]), np.array([-4.0, 2.0])).at(np.array([False, True]))
    alone = RateOverstress.over_step(
        stress, log_rate, (STRESS_SCALE[1:], LOG_COEFFICIENT[1:]), STEP
    ).scaled(np.array([9e7]), np.array([2.0]))
    np.testing.assert_allclose(second(INCREMENT[1:]), alone(INCREMENT[1:]), rtol=1e-14)
