"""Linear isotropic hardening: R = H ξ, with H over temperature."""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.flow import PLASTIC, isotropic_hardening, solid_flow
from tests.castx.materials.descriptions import alloy, described

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    "hardening", [[[100, 2e9], [500, 1e9]], {"linear": [[100, 2e9], [500, 1e9]]}]
)
def test_hardening_is_the_modulus_times_the_strain(hardening) -> None:
    """A number or a table in place of the keys of `hardening` is this modulus."""
    material = alloy(yield_stress=1e8, hardening=hardening)
    temperature, strain = np.array([100.0, 400.0]), np.array([0.01, 0.2])
    properties = solid_flow(material, PLASTIC, np.full(2, 26e9), temperature, 1.0)
    np.testing.assert_allclose(properties.hardening_modulus, [2e9, 1.25e9])
    np.testing.assert_allclose(isotropic_hardening(properties, strain), [2e7, 2.5e8])
    assert not properties.hardening_curves


def test_a_modulus_of_zero_is_no_hardening() -> None:
    assert not described(hardening=0.0).hardening.acts
    assert described(hardening=1.0, yield_stress=1e6).hardening.acts
