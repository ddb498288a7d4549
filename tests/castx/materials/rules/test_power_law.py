"""Overstress of a power law: inverse, slope, scaling and points."""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.rules.power_law import PowerLaw

pytestmark = pytest.mark.serial

LAW = PowerLaw(np.array([2e6, 3e8, 0.0, 5e7]), np.array([1.0, 0.2, 1.0, 1.7]))
INCREMENT = np.array([1e-3, 2e-5, 0.1, 0.5])


def test_values_and_where_it_is_curved() -> None:
    expected = np.array([2e3, 3e8 * 2e-5**0.2, 0.0, 5e7 * 0.5**1.7])
    np.testing.assert_allclose(LAW(INCREMENT), expected, rtol=1e-14)
    np.testing.assert_array_equal(LAW.curved, [False, True, False, True])
    np.testing.assert_array_equal(LAW.modulus[~LAW.curved], [2e6, 0.0])
    none = PowerLaw.none(np.array([20.0, 500.0]))
    np.testing.assert_array_equal(none(np.ones(2)), 0.0)
    assert not none.curved.any()


def test_evaluation_over_the_logarithm() -> None:
    y, h = np.log(INCREMENT), 1e-5
    value, slope = LAW.evaluate(y)
    np.testing.assert_allclose(value, LAW(INCREMENT), rtol=1e-12)
    difference = (LAW.evaluate(y + h)[0] - LAW.evaluate(y - h)[0]) / (2 * h)
    np.testing.assert_allclose(slope, difference, rtol=1e-8)


def test_the_inverse() -> None:
    law, increment = (part.at(LAW.resistance > 0) for part in (LAW, PowerLaw(INCREMENT, INCREMENT)))
    found = law.logarithm(law(increment.power))
    np.testing.assert_allclose(np.exp(found), increment.power, rtol=1e-12)
    half = law(np.exp(law.logarithm_of_half()))
    np.testing.assert_allclose(half, 0.5, rtol=1e-12)


def test_scales_of_stress_and_increment() -> None:
    stress, logarithm = np.array([1e5, 2e7, 1e6, 3.0]), np.array([-2.0, 1.0, 0.0, 3.0])
    with np.errstate(divide="ignore"):
        scaled = LAW.scaled(stress, logarithm)
    expected = LAW(INCREMENT) / stress
    np.testing.assert_allclose(scaled(INCREMENT / np.exp(logarithm)), expected, rtol=1e-12)


def test_some_points() -> None:
    some = np.array([3, 1])
    np.testing.assert_array_equal(LAW.at(some)(INCREMENT[some]), LAW(INCREMENT)[some])
