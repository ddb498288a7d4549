"""Thermal strain by hand, with and without a reference, and the strain of solidification."""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.thermal_strain import (
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
