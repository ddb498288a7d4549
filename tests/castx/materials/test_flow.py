"""Properties of flow against the laws of the case format, and what a material needs for them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from castx.errors import CaseError
from castx.materials.flow import (
    PLASTIC,
    VISCOPLASTIC,
    check_law,
    isotropic_hardening,
    liquid_flow,
    solid_flow,
)
from tests.castx.materials.descriptions import alloy

pytestmark = pytest.mark.serial

MODULUS = np.array([20e9, 26e9])
TEMPERATURE = np.array([100.0, 400.0])
ABSOLUTE = TEMPERATURE + 273.15
NORTON = {"law": "norton", "coefficient": 1e-40, "exponent": 5, "activation_energy": 1.4e5}


def overstress(properties, increment):
    return properties.viscous_resistance * increment**properties.viscous_power


@given(f=st.floats(1e5, 1e9), step=st.floats(1e-3, 1e3))
def test_perzyna(f: float, step: float) -> None:
    """Rate (f/viscosity)^exponent, viscosity and exponent tables over temperature."""
    keys = {"viscosity": [[100, 1e9], [500, 5e8]], "exponent": [[100, 2], [500, 6]]}
    properties = solid_flow(
        alloy(**keys, yield_stress=1e8), VISCOPLASTIC, MODULUS, TEMPERATURE, step
    )
    rate = (f / np.array([1e9, 6.25e8])) ** np.array([2.0, 5.0])
    np.testing.assert_allclose(overstress(properties, rate * step), f, rtol=1e-11)


@given(f=st.floats(1e5, 1e9), step=st.floats(1e-3, 1e3))
def test_bingham(f: float, step: float) -> None:
    """Rate f/(3 viscosity)."""
    material = alloy(law="bingham", viscosity=[[100, 1e9], [500, 5e8]], yield_stress=0)
    properties = solid_flow(material, VISCOPLASTIC, MODULUS, TEMPERATURE, step)
    rate = f / (3 * np.array([1e9, 6.25e8]))
    np.testing.assert_allclose(overstress(properties, rate * step), f, rtol=1e-12)
    assert (properties.yield_stress == 0.0).all()


@pytest.mark.parametrize("place", ["solid", "liquid"])
@given(q=st.floats(1e5, 1e9), step=st.floats(1e-3, 1e3))
def test_norton(place: str, q: float, step: float) -> None:
    """Rate coefficient q^exponent exp(−activation_energy/(R T_K)), no yield stress or hardening."""
    keys: dict[str, Any] = {
        "coefficient": [[0, 1e-40], [400, 3e-40]],
        "exponent": [[0, 5.0], [400, 4.0]],
        "activation_energy": [[0, 1.2e5], [400, 1.6e5]],
    }
    if place == "solid":
        extra = {"yield_stress": 5e7, "hardening": 1e9, "kinematic_hardening": 1e9}
        material = alloy(law="norton", **keys, **extra)
        properties = solid_flow(material, VISCOPLASTIC, MODULUS, TEMPERATURE, step)
    else:
        material = alloy(liquid={"model": "norton", "coherency": 0.7, **keys})
        properties = liquid_flow(material, MODULUS, TEMPERATURE, step)
    rate = (
        np.array([1.5e-40, 3e-40])
        * q ** np.array([4.75, 4.0])
        * np.exp(-np.array([1.3e5, 1.6e5]) / (8.314462618 * ABSOLUTE))
    )
    np.testing.assert_allclose(overstress(properties, rate * step), q, rtol=1e-10)
    for name in ("yield_stress", "linear_hardening", "saturation", "kinematic_hardening"):
        assert not getattr(properties, name).any()
    np.testing.assert_array_equal(properties.shear_modulus, MODULUS)


def test_plasticity_knows_no_rate() -> None:
    keys = {"yield_stress": [[100, 1e8], [500, 2e7]], "hardening": [[100, 2e9], [500, 1e9]],
            "kinematic_hardening": [[100, 4e9], [500, 0]], "viscosity": 1e9}  # fmt: skip
    properties = solid_flow(alloy(**keys), PLASTIC, MODULUS, TEMPERATURE, 1.0)
    np.testing.assert_allclose(properties.yield_stress, [1e8, 4e7])
    np.testing.assert_allclose(properties.linear_hardening, [2e9, 1.25e9])
    np.testing.assert_allclose(properties.kinematic_hardening, [4e9, 1e9])
    np.testing.assert_array_equal(properties.shear_modulus, MODULUS)
    assert not properties.viscous_resistance.any()


def test_hardening_is_linear_and_saturates() -> None:
    hardening = {
        "linear": 1e9,
        "saturation": [[100, 8e7], [500, 4e7]],
        "rate": [[100, 5], [500, 9]],
    }
    material = alloy(yield_stress=1e8, hardening=hardening)
    properties = solid_flow(material, PLASTIC, MODULUS, TEMPERATURE, 1.0)
    strain = np.array([0.01, 0.2])
    expected = 1e9 * strain + np.array([8e7, 5e7]) * (1 - np.exp(-np.array([5, 8]) * strain))
    np.testing.assert_allclose(isotropic_hardening(properties, strain), expected, rtol=1e-12)


@pytest.mark.parametrize("temperature", [-273.15, -273.0, -200.0, 1e4])
@pytest.mark.parametrize("step", [1e-6, 1e4])
def test_norton_has_numbers_at_every_temperature(temperature: float, step: float) -> None:
    properties = solid_flow(alloy(**NORTON), VISCOPLASTIC, MODULUS, np.full(2, temperature), step)
    assert np.isfinite(properties.viscous_resistance).all()
    assert (properties.viscous_resistance > 0.0).all()


@pytest.mark.parametrize(
    ("law", "keys", "message"),
    [
        (PLASTIC, {}, r"'alloy' cannot serve the law 'thermo-elasto-plastic': yield_stress: miss"),
        (PLASTIC, {"yield_stress": 0}, r"yield_stress: zero at every temperature.*viscoplastic"),
        (VISCOPLASTIC, {"yield_stress": 1e8}, r": viscosity: missing; law = \"perzyna\" flows by"),
        (VISCOPLASTIC, {"viscosity": 1e8}, r"yield_stress: missing; .*\(0: it flows at every str"),
        (VISCOPLASTIC, {}, r"viscosity: missing.*; yield_stress: missing"),
        (VISCOPLASTIC, {"law": "bingham", "yield_stress": 0}, r"viscosity: missing; .*bingham"),
        (VISCOPLASTIC, {"law": "norton"}, r"coefficient: missing; law = \"norton\" flows by"),
        ("thermo-elastic", None, r"the law 'thermo-elastic' does not flow; 'thermo-elasto-plast"),
    ],
)
def test_what_a_law_lacks_is_named(law, keys, message) -> None:
    material = alloy(**(keys or {}))
    if keys is not None:
        with pytest.raises(CaseError, match=message):
            check_law(material, law)
    with pytest.raises(CaseError, match=message):
        solid_flow(material, law, MODULUS, TEMPERATURE, 1.0)


def test_what_a_law_needs_is_enough() -> None:
    check_law(alloy(**NORTON), VISCOPLASTIC)
    check_law(alloy(viscosity=1e9, yield_stress=0), VISCOPLASTIC)
    check_law(alloy(yield_stress=[[20, 1e8], [550, 0]]), PLASTIC)
    check_law(alloy(**NORTON, yield_stress=1e8), PLASTIC)
    check_law(alloy(), "thermo-elastic")


@pytest.mark.parametrize("liquid", [None, {"viscosity": 1e6, "coherency": 0.7}])
def test_only_a_norton_liquid_flows_by_a_power_law(liquid) -> None:
    with pytest.raises(CaseError, match=r"'alloy' has no liquid with model = \"norton\""):
        liquid_flow(alloy(liquid=liquid), MODULUS, TEMPERATURE, 1.0)
