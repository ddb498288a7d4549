"""Prager's kinematic hardening: the modulus of the back stress, over temperature."""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.flow import PLASTIC, VISCOPLASTIC, solid_flow
from tests.castx.materials.descriptions import alloy

pytestmark = pytest.mark.serial

MODULUS, TEMPERATURE = np.array([20e9, 26e9]), np.array([100.0, 400.0])
KEYS = {"yield_stress": 1e8, "kinematic_hardening": [[100, 4e9], [500, 0]]}


@pytest.mark.parametrize("law", [PLASTIC, VISCOPLASTIC])
def test_the_modulus_of_the_back_stress(law: str) -> None:
    properties = solid_flow(alloy(**KEYS, viscosity=1e9), law, MODULUS, TEMPERATURE, 1.0)
    np.testing.assert_allclose(properties.kinematic_modulus, [4e9, 1e9])
    assert not properties.hardening_modulus.any() and not properties.hardening_curves


def test_creep_without_threshold_has_no_back_stress() -> None:
    material = alloy(**KEYS, law="norton", coefficient=1e-40)
    properties = solid_flow(material, VISCOPLASTIC, MODULUS, TEMPERATURE, 1.0)
    assert not properties.kinematic_modulus.any()
