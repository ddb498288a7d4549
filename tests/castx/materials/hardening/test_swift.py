"""Swift's hardening: R = K ((ξ0 + ξ)ⁿ − ξ0ⁿ) by hand, over temperature, and refusals."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError
from castx.materials.flow import PLASTIC, isotropic_hardening, solid_flow
from castx.materials.hardening.swift import SwiftCurve
from tests.castx.materials.descriptions import alloy, described

pytestmark = pytest.mark.serial

SWIFT = {"strength": "400 MPa", "prestrain": 0.01, "exponent": 0.5}


def flow(points, temperature=20.0, **hardening):
    material = alloy(yield_stress=4e7, hardening=hardening or SWIFT)
    return solid_flow(material, PLASTIC, np.full(points, 26e9), np.full(points, temperature), 1.0)


def test_numbers_by_hand():
    """√0.01 = 0.1, √0.04 = 0.2, √0.09 = 0.3: 40 and 80 MPa above the yield stress K ξ0ⁿ."""
    found = isotropic_hardening(flow(3), np.array([0.0, 0.03, 0.08]))
    np.testing.assert_allclose(found, [0.0, 4e7, 8e7], rtol=1e-12)


def test_keys_over_temperature_and_beside_linear_hardening():
    strength = [[100.0, 4e8], [500.0, 2e8]]
    found = isotropic_hardening(
        flow(1, 300.0, linear=1e9, strength=strength, prestrain=0.01, exponent=0.5),
        np.array([0.03]),
    )
    np.testing.assert_allclose(found, 3e7 + 3e7, rtol=1e-12)


def test_an_exponent_of_one_is_linear_hardening():
    curve = SwiftCurve(np.array([4e6]), np.array([0.01]), np.array([1.0]))
    strain = np.array([0.25])
    np.testing.assert_allclose([curve(strain), *curve.evaluate(strain)], 1e8, rtol=1e-12)
    assert curve.steepest == pytest.approx(4e8)
    assert not SwiftCurve(0.0 * strain, strain, strain).curved


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"prestrain": 0.0}, "hardening.prestrain: must be positive"),
        ({"exponent": 1.5}, "hardening.exponent: must be positive and at most 1"),
        ({"strength": -1.0}, "hardening.strength: must be at least 0"),
    ],
)
def test_refusals(change, message):
    with pytest.raises(CaseError, match=message):
        described(yield_stress=4e7, hardening=SWIFT | change)


@pytest.mark.parametrize("lacking", SWIFT)
def test_all_keys_are_needed(lacking):
    given = {key: value for key, value in SWIFT.items() if key != lacking}
    others = " and ".join(given)
    with pytest.raises(CaseError, match=f"{lacking}: missing; it is needed with {others} .Swift"):
        described(yield_stress=4e7, hardening=given)
