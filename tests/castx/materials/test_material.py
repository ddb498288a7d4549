"""What a material gives the solvers, and how it names what it lacks."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError
from castx.materials.material import Material
from tests.castx.materials.descriptions import alloy, described

pytestmark = pytest.mark.serial


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


def test_the_stress_free_temperature_is_given_or_the_solidus_or_the_initial_one() -> None:
    mould = alloy(
        solidus=None, liquidus=None, latent_heat=None, heat_capacity=500.0, conductivity=30.0
    )
    assert alloy().stress_free_temperature(700.0) == 550.0
    assert alloy(stress_free=400.0).stress_free_temperature(700.0) == 400.0
    assert mould.stress_free_temperature(200.0) == 200.0


def test_without_liquid_nothing_but_the_shrinkage_changes() -> None:
    """A body that stays solid does not shrink by freezing."""
    material = alloy(liquid={"viscosity": 1e6, "coherency": 0.7}, solidification_shrinkage=0.05)
    solid = material.without_liquid()
    assert material.liquid is not None and solid.liquid is None
    assert solid.description.solidification_shrinkage == 0.0
    back = {"liquid": material.liquid, "solidification_shrinkage": 0.05}
    assert solid.description.model_copy(update=back) == material.description


@pytest.mark.parametrize("law", ["scheil", "lever"])
def test_the_law_of_the_solid_fraction_is_that_of_the_description(law) -> None:
    """With k = 0.5, T_m = 660 °C, T_l = 610 °C; at 600 °C the ratio of depressions is 60/50."""
    material = alloy(solid_fraction=law, partition_coefficient=0.5, melting_point=660.0)
    expected = {"scheil": 1 - (60 / 50) ** -2, "lever": 10 / (0.5 * 60)}[law]
    assert material.solid_fraction_at(np.array([600.0]))[0] == pytest.approx(expected, rel=1e-12)


LIQUID = {"viscosity": 1e5, "coherency": 0.6}


@pytest.mark.parametrize("liquidus", [560.0, 610.0])
def test_an_alloy_bears_beyond_coherency_and_a_pure_metal_behind_its_front(liquidus: float) -> None:
    given = {"solidus": 560.0, "liquidus": liquidus, "latent_heat": 4e5, "liquid": LIQUID}
    metal = Material("metal", described(**given))
    isothermal = liquidus == 560.0
    assert metal.is_isothermal == isothermal
    assert metal.fed_until == (1.0 if isothermal else 0.6)
    fraction = np.array([0.0, 0.3, 0.6, 0.7, 1.0])
    expected = fraction if isothermal else [0.0, 0.0, 0.0, 0.25, 1.0]
    np.testing.assert_allclose(metal.bearing_share(fraction), expected, atol=1e-12)
    assert np.all(metal.without_liquid().bearing_share(fraction) == 1.0)
    assert metal.without_liquid().fed_until == 0.0


def test_a_front_on_a_plateau_with_coherency_is_fed_to_its_end() -> None:
    """Beyond a plateau from 0.3 to 0.7 the mush bears; below it coherency is where feeding ends."""
    rows = [[540.0, 1.0], [560.0, 0.7], [560.0, 0.3], [610.0, 0.0]]
    for coherency, fed in ((0.2, 0.2), (0.3, 0.7), (0.6, 0.7), (0.7, 0.7), (0.8, 0.8), (1.0, 1.0)):
        metal = alloy(
            solid_fraction=rows,
            solidus=None,
            liquidus=None,
            liquid={**LIQUID, "coherency": coherency},
        )
        assert metal.fed_until == pytest.approx(fed), coherency
        assert metal.plateaus


def test_coherency_of_one_bears_where_all_is_solid() -> None:
    metal = alloy(liquid={**LIQUID, "coherency": 1.0})
    np.testing.assert_array_equal(metal.bearing_share(np.array([0.5, 0.999, 1.0])), [0, 0, 1])


def test_melt_lets_go_of_a_wall_at_its_depression_or_the_atmosphere() -> None:
    assert alloy().wall_suction == 1.01e5
    assert alloy(cavitation=2e4).wall_suction == 2e4
    assert alloy(cavitation=0.0).wall_suction == 0.0
