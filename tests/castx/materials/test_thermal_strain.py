"""Thermal strain by hand, with and without a reference, and the strain of solidification."""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.description import MaterialDescription
from castx.materials.lookup import find_material
from castx.materials.thermal_strain import (
    StressFreeState,
    liquid_shrinkage,
    shrinkage_strain,
    volumetric_thermal_strain,
)
from tests.castx.materials.descriptions import alloy

pytestmark = pytest.mark.serial


def test_thermal_strain_from_the_stress_free_temperature() -> None:
    material = alloy(expansion=2.4e-5)
    assert material.stress_free_temperature(700.0) == 550.0
    strain = volumetric_thermal_strain(material, np.array([20.0, 550.0, 600.0]), 550.0)
    np.testing.assert_allclose(strain, [3 * 2.4e-5 * -530.0, 0.0, 0.0])


def test_thermal_strain_with_another_reference() -> None:
    # alpha(T) = 22e-6 + (T - 100)·1e-8 between 100 and 500 °C, mean from 20 °C; T_sf = 400 °C
    material = alloy(expansion_reference=20.0, stress_free=400.0)
    born = 25e-6 * 380.0
    expected = [
        3 * (22e-6 * 0.0 - born),  # 20 °C
        3 * (23e-6 * 180.0 - born),  # 200 °C
        0.0,  # 400 °C
        0.0,  # 450 °C: it melts
    ]
    strain = volumetric_thermal_strain(material, np.array([20.0, 200.0, 400.0, 450.0]), 400.0)
    np.testing.assert_allclose(strain, expected, atol=1e-18)
    assert material.stress_free_temperature(700.0) == 400.0


def test_thermal_strain_of_what_never_melts_goes_on_above() -> None:
    mould = alloy(
        solidus=None, liquidus=None, latent_heat=None, heat_capacity=500.0, conductivity=30.0
    )
    assert mould.stress_free_temperature(200.0) == 200.0
    # reference default: the stress-free temperature
    strain = volumetric_thermal_strain(mould, np.array([100.0, 300.0]), 200.0)
    np.testing.assert_allclose(strain, [3 * 22e-6 * -100.0, 3 * 24e-6 * 100.0])


def strain(state, material, temperature, fraction=1.0):
    T, fraction = np.atleast_1d(temperature), np.atleast_1d(fraction)
    found = state.thermal_strain(material, T) + state.shrinkage(material, fraction)
    return found if len(found) > 1 else found[0]


@pytest.mark.parametrize("given", [None, 20.0, 120.0, 500.0])
def test_copper_that_starts_solid_expands_from_its_reference(given) -> None:
    """e^θ = 3[α(T)(T − 20) − α(T_sf)(T_sf − 20)] with the table of the database."""
    changed = {} if given is None else {"stress_free": given}
    description = MaterialDescription.read({"extends": "Cu-pure", **changed})
    copper = find_material("chill", {"chill": description})
    state = StressFreeState.at_start(copper, 120.0, 120.0)
    mean = {20.0: 16.8e-6, 120.0: 16.9e-6, 500.0: 18.6e-6, 900.0: 20.3e-6, 1084.62: 21.1e-6}
    free = given or 120.0
    for T, alpha in mean.items():
        expected = 3 * (alpha * (T - 20.0) - mean[free] * (free - 20.0))
        assert strain(state, copper, T) == pytest.approx(expected, rel=1e-12, abs=1e-16)
    molten = strain(state, copper, 1084.62, 0.0)
    assert strain(state, copper, 1500.0, 0.0) == molten == strain(state, copper, np.inf, 0.0)


def test_a_field_is_free_of_strain_where_it_is_solid_and_melts_as_a_casting_does() -> None:
    material = alloy(expansion=2e-5, solidification_shrinkage=0.06)
    initial = np.array([20.0, 300.0, 600.0])
    state = StressFreeState.at_start(material, initial, 600.0)
    fraction = material.solid_fraction_at(initial)
    start = strain(state, material, initial, fraction)
    mushy = float(shrinkage_strain(material, fraction[2]))
    np.testing.assert_allclose(start, np.array([0.0, 0.0, mushy]), atol=1e-18)
    cold = strain(state, material, np.full(3, 20.0), np.ones(3))
    expected = [0.0, -6e-5 * 280.0, -6e-5 * 530.0 - 0.06]
    np.testing.assert_allclose(cold, expected, atol=1e-16)
    # Molten, the cold node gains what the metal loses when it freezes and cools to 20 °C.
    molten = strain(state, material, np.full(3, np.inf), np.zeros(3))
    np.testing.assert_allclose(molten, [6e-5 * 530.0 + 0.06, 6e-5 * 250.0 + 0.06, 0.0])


def test_the_database_speaks_of_castings_and_the_case_of_its_bodies() -> None:
    bronze = find_material("CuSn12")
    assert bronze.stress_free == bronze.contraction_start == 870.0
    assert bronze.given_stress_free is None
    assert StressFreeState.at_start(bronze, 20.0, 20.0).temperature == 20.0
    assert StressFreeState.at_start(bronze, 1100.0, 1100.0).temperature == 870.0
    description = MaterialDescription.read({"extends": "CuSn12", "stress_free": 200.0})
    own = find_material("own", {"own": description})
    assert StressFreeState.at_start(own, 20.0, 20.0).temperature == 200.0
    assert strain(StressFreeState.at_start(own, 20.0, 20.0), own, 500.0) > 0.0
    frozen = StressFreeState.at_start(own, 1100.0, 1100.0)
    assert frozen.thermal_strain(own, np.array([500.0]))[0] == 0.0, "a casting contracts only below"


def test_without_expansion_there_is_no_strain() -> None:
    strain = volumetric_thermal_strain(alloy(expansion=None), np.array([20.0, 500.0]), 550.0)
    np.testing.assert_array_equal(strain, [0.0, 0.0])


def test_only_the_shrinkage_after_coherency_strains_the_skeleton() -> None:
    liquid = {"viscosity": 1e6, "coherency": 0.6}
    material = alloy(liquid=liquid, solidification_shrinkage=0.06)
    fraction = np.array([[0.0, 0.6, 0.7], [0.8, 1.0, 1.0]])
    expected = -0.06 * np.array([[0.0, 0.0, 0.1], [0.2, 0.4, 0.4]])
    np.testing.assert_allclose(shrinkage_strain(material, fraction), expected, atol=1e-16)
    graphite = alloy(solidification_shrinkage=-0.02)  # without liquid: from the first solid
    np.testing.assert_allclose(shrinkage_strain(graphite, fraction), 0.02 * fraction)
    last = alloy(liquid=liquid | {"coherency": 1.0}, solidification_shrinkage=0.06)
    np.testing.assert_array_equal(shrinkage_strain(last, fraction), np.zeros((2, 3)))


@pytest.mark.parametrize("coherency", [0.6, 1.0])
def test_liquid_and_skeleton_shrink_by_the_whole_together(coherency: float) -> None:
    liquid = {"viscosity": 1e6, "coherency": coherency}
    material = alloy(liquid=liquid, solidification_shrinkage=0.06)
    fraction = np.linspace(0.0, 1.0, 11)
    before = liquid_shrinkage(material, fraction)
    np.testing.assert_allclose(before - shrinkage_strain(material, fraction), 0.06 * fraction)
    np.testing.assert_allclose(before, 0.06 * np.minimum(fraction, coherency))
    assert not liquid_shrinkage(alloy(solidification_shrinkage=0.06), fraction).any()


def test_strain_of_freezing_metal_at_a_solid_fraction() -> None:
    """Free of strain at 590 °C, coherent at 580, solid at 550: cooled by 10 and by 40 K."""
    liquid = {"viscosity": 1e6, "coherency": 0.5}
    metal = alloy(
        liquidus=610.0, liquid=liquid, expansion=2e-5, stress_free=590.0,
        solidification_shrinkage=0.06,
    )  # fmt: skip
    state = StressFreeState.at_start(metal, 620.0, 620.0)
    born, frozen = (float(state.strain_at(metal, fraction)) for fraction in (0.5, 1.0))
    assert born == pytest.approx(-3 * 2e-5 * 10.0, rel=1e-9)
    assert frozen == pytest.approx(-3 * 2e-5 * 40.0 - 0.5 * 0.06, rel=1e-9)
