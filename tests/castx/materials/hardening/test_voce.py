"""Voce's hardening: R = R_∞ (1 − exp(−b ξ)), its rest after some strain, its slope and scaling."""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.flow import PLASTIC, isotropic_hardening, solid_flow
from castx.materials.hardening.voce import VoceCurve
from tests.castx.materials.descriptions import alloy

pytestmark = pytest.mark.serial

CURVE = VoceCurve(np.array([8e7, 5e7, 0.0]), np.array([5.0, 80.0, 3.0]))
STRAIN = np.array([0.02, 0.01, 0.3])


def test_hardening_of_a_material_over_temperature() -> None:
    hardening = {"linear": 1e9, "saturation": [[100, 8e7], [500, 4e7]],
                 "rate": [[100, 5], [500, 9]]}  # fmt: skip
    material = alloy(yield_stress=1e8, hardening=hardening)
    temperature = np.array([100.0, 400.0])
    properties = solid_flow(material, PLASTIC, np.full(2, 26e9), temperature, 1.0)
    strain = np.array([0.01, 0.2])
    expected = 1e9 * strain + np.array([8e7, 5e7]) * (1 - np.exp(-np.array([5, 8]) * strain))
    np.testing.assert_allclose(isotropic_hardening(properties, strain), expected, rtol=1e-12)


def test_what_is_left_after_some_strain() -> None:
    more = np.array([1e-3, 0.04, 0.1])
    np.testing.assert_allclose(
        CURVE.after(STRAIN)(more), CURVE(STRAIN + more) - CURVE(STRAIN), rtol=1e-12
    )


def test_the_slope_by_differences() -> None:
    h = 1e-4 * STRAIN
    slope = (CURVE(STRAIN + h) - CURVE(STRAIN - h)) / (2 * h)
    value, steepness = CURVE.evaluate(STRAIN)
    np.testing.assert_array_equal(value, CURVE(STRAIN))
    np.testing.assert_allclose(steepness, STRAIN * slope, rtol=1e-6)
    tiny = np.full(3, 1e-9)
    np.testing.assert_allclose(CURVE(tiny) / tiny, CURVE.steepest, rtol=1e-6)
    np.testing.assert_array_equal(CURVE.curved, [True, True, False])


def test_scales_of_stress_and_strain() -> None:
    stress, logarithm = np.array([1e6, 3e7, 2e5]), np.array([-3.0, 0.5, 2.0])
    scaled = CURVE.scaled(stress, logarithm)
    np.testing.assert_allclose(scaled(STRAIN / np.exp(logarithm)), CURVE(STRAIN) / stress)
    np.testing.assert_array_equal(scaled.at(np.array([1]))(STRAIN[1:2]), scaled(STRAIN)[1:2])
