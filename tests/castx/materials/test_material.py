"""Thermal strain by hand, conductivity and its derivative, what a law requires, ranges and rows."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError
from castx.materials.material import Material
from castx.materials.sources import PropertyRow
from tests.castx.materials.descriptions import alloy, described

pytestmark = pytest.mark.serial


def test_thermal_strain_from_the_stress_free_temperature() -> None:
    material = alloy(expansion=2.4e-5)
    assert material.stress_free_temperature(700.0) == 550.0
    strain = material.volumetric_thermal_strain(np.array([20.0, 550.0, 600.0]), 550.0)
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
    strain = material.volumetric_thermal_strain(np.array([20.0, 200.0, 400.0, 450.0]), 400.0)
    np.testing.assert_allclose(strain, expected, atol=1e-18)
    assert material.stress_free_temperature(700.0) == 400.0


def test_thermal_strain_of_what_never_melts_goes_on_above() -> None:
    mould = alloy(
        solidus=None, liquidus=None, latent_heat=None, heat_capacity=500.0, conductivity=30.0
    )
    assert mould.stress_free_temperature(200.0) == 200.0
    # reference default: the stress-free temperature
    strain = mould.volumetric_thermal_strain(np.array([100.0, 300.0]), 200.0)
    np.testing.assert_allclose(strain, [3 * 22e-6 * -100.0, 3 * 24e-6 * 100.0])


def test_without_expansion_there_is_no_strain() -> None:
    strain = alloy(expansion=None).volumetric_thermal_strain(np.array([20.0, 500.0]), 550.0)
    np.testing.assert_array_equal(strain, [0.0, 0.0])


@pytest.mark.parametrize("law", ["linear", [[550, 0.8], [610, 0]]])
def test_conductivity_follows_the_enthalpy(law) -> None:
    material = alloy(solid_fraction=law)
    curve = material.enthalpy
    enthalpy = np.linspace(curve.enthalpy(100.0), curve.enthalpy(700.0), 401) + 0.5
    value, slope = material.conductivity_at(enthalpy)
    fraction = curve.solid_fraction(enthalpy)
    temperature = curve.temperature(enthalpy)
    solid = np.interp(temperature, [20, 500], [200, 160])
    np.testing.assert_allclose(value, fraction * solid + (1 - fraction) * 80.0)
    step = 1e3
    ahead, behind = (material.conductivity_at(enthalpy + sign * step)[0] for sign in (1, -1))
    smooth = np.ones_like(enthalpy, dtype=bool)
    for bend in (500.0, 550.0 - 1e-9, 550.0, 610.0):
        smooth &= np.abs(enthalpy - curve.enthalpy(bend)) > 2 * step
    difference = (ahead - behind) / (2 * step)
    scale = np.abs(slope).max()
    np.testing.assert_allclose(slope[smooth], difference[smooth], atol=1e-3 * scale)


def test_missing_properties_are_named() -> None:
    material = alloy(density=None, expansion=None)
    with pytest.raises(CaseError, match=r"'alloy' has no density, needed by the heat equation"):
        _ = material.enthalpy
    with pytest.raises(CaseError, match=r"no density, expansion, needed by the law of 'casting'"):
        material.require(("density", "conductivity", "expansion"), "the law of 'casting'")
    material.require(("young_modulus",), "anything")


def test_melts() -> None:
    assert alloy().melts
    assert (alloy().solidus, alloy().liquidus) == (550.0, 610.0)
    mould = Material("m", described(solidus=None, liquidus=None, latent_heat=None,
                                    heat_capacity=500.0, conductivity=30.0))  # fmt: skip
    assert not mould.melts
    assert mould.solid_fraction is None
    assert mould.latent_heat == 0.0


def test_solidus_comes_from_the_table_of_the_solid_fraction() -> None:
    table = [[20, 1], [560, 1], [600, 0.2], [605, 0], [900, 0]]
    material = alloy(solidus=None, liquidus=None, solid_fraction=table)
    assert (material.solidus, material.liquidus) == (560.0, 605.0)


def test_outside_range_looks_at_each_phase_where_it_is() -> None:
    material = alloy(heat_capacity={"solid": [[20, 900], [550, 1000]], "liquid": 1200.0})
    assert material.outside_range(100.0, 500.0) == []
    names = [entry.property for entry in material.outside_range(50.0, 700.0)]
    assert names == ["conductivity.solid", "expansion"]
    wet = alloy(conductivity={"solid": 160.0, "liquid": [[600, 80], [650, 85]]}, expansion=2e-5)
    assert wet.outside_range(20.0, 640.0) == []
    assert wet.outside_range(20.0, 700.0) == [("conductivity.liquid", (600.0, 650.0))]
    (entry,) = material.outside_range(50.0, 400.0)
    assert entry == ("expansion", (100.0, 500.0))


def test_rows_hold_every_number() -> None:
    rows = alloy(expansion_reference="20 degC", young_modulus=[["20 degC", "70 GPa"]]).rows()
    assert PropertyRow("density", None, 2500.0, "kg/m³", "case file") in rows
    assert PropertyRow("conductivity.solid", 500.0, 160.0, "W/m/K", "case file") in rows
    assert PropertyRow("solid_fraction", None, "linear", "", "default of castx") in rows
    assert PropertyRow("young_modulus", None, 70e9, "Pa", "case file") in rows
    assert sum(row.property == "expansion" for row in rows) == 2
