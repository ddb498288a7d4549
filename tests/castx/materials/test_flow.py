"""Properties of flow at points, and what a material needs for the law of a body."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError
from castx.materials.flow import (
    PLASTIC,
    VISCOPLASTIC,
    check_law,
    isotropic_hardening,
    liquid_flow,
    solid_flow,
)
from castx.materials.inelastic import LIQUID_RULES
from tests.castx.materials.descriptions import alloy

pytestmark = pytest.mark.serial

MODULUS = np.array([20e9, 26e9])
TEMPERATURE = np.array([100.0, 400.0])
NORTON = {"law": "norton", "coefficient": 1e-40, "exponent": 5, "activation_energy": 1.4e5}


def test_plasticity_knows_no_rate() -> None:
    keys = {"yield_stress": [[100, 1e8], [500, 2e7]], "hardening": [[100, 2e9], [500, 1e9]],
            "kinematic_hardening": [[100, 4e9], [500, 0]], "viscosity": 1e9}  # fmt: skip
    properties = solid_flow(alloy(**keys), PLASTIC, MODULUS, TEMPERATURE, 1.0)
    np.testing.assert_allclose(properties.yield_stress, [1e8, 4e7])
    np.testing.assert_allclose(properties.hardening_modulus, [2e9, 1.25e9])
    np.testing.assert_allclose(properties.kinematic_modulus, [4e9, 1e9])
    np.testing.assert_array_equal(properties.shear_modulus, MODULUS)
    assert not properties.overstress(np.ones(2)).any()


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


def test_properties_of_some_points() -> None:
    hardening = {"linear": 1e9, "saturation": [[100, 8e7], [500, 4e7]], "rate": 5}
    keys = {"yield_stress": [[100, 1e8], [500, 2e7]], "hardening": hardening}
    material = alloy(**keys, kinematic_hardening=2e9, viscosity=[[100, 1e9], [500, 5e8]])
    both = solid_flow(material, VISCOPLASTIC, MODULUS, TEMPERATURE, 0.1)
    second = solid_flow(material, VISCOPLASTIC, MODULUS[1:], TEMPERATURE[1:], 0.1)
    for found in (both.at(np.array([1])), both.at(np.array([False, True]))):
        strain = np.array([0.03])
        np.testing.assert_array_equal(found.yield_stress, second.yield_stress)
        np.testing.assert_array_equal(found.kinematic_modulus, second.kinematic_modulus)
        np.testing.assert_array_equal(found.shear_modulus, second.shear_modulus)
        np.testing.assert_array_equal(found.overstress(strain), second.overstress(strain))
        np.testing.assert_array_equal(
            isotropic_hardening(found, strain), isotropic_hardening(second, strain)
        )


def test_what_a_law_needs_is_enough() -> None:
    check_law(alloy(**NORTON), VISCOPLASTIC)
    check_law(alloy(viscosity=1e9, yield_stress=0), VISCOPLASTIC)
    check_law(alloy(yield_stress=[[20, 1e8], [550, 0]]), PLASTIC)
    check_law(alloy(**NORTON, yield_stress=1e8), PLASTIC)
    check_law(alloy(), "thermo-elastic")


@pytest.mark.parametrize("liquid", [None, {"viscosity": 1e6, "coherency": 0.7}])
def test_a_newtonian_liquid_flows_by_no_rule(liquid) -> None:
    models = " or ".join(f'"{name}"' for name in LIQUID_RULES)
    with pytest.raises(CaseError, match=f"'alloy' has no liquid with model = {models}$"):
        liquid_flow(alloy(liquid=liquid), MODULUS, TEMPERATURE, 1.0)


@pytest.mark.parametrize("name", LIQUID_RULES)
def test_a_liquid_flows_by_the_rule_of_its_model(name) -> None:
    rule, increment = LIQUID_RULES[name], np.array([1e-3, 1e-3])
    material = alloy(liquid={"model": name, "coherency": 0.7, **rule.example})
    properties = liquid_flow(material, MODULUS, TEMPERATURE, 0.5)
    values = {key: np.full(2, value) for key, value in rule.example.items()}
    expected = rule.overstress(values, TEMPERATURE, 0.5)(increment)
    np.testing.assert_array_equal(properties.overstress(increment), expected)
    assert not properties.yield_stress.any() and not properties.kinematic_modulus.any()
