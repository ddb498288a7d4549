"""Numbers of steel, zinc, brass, pearlitic iron and silumin beside what their sources give."""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.database import database_entry, database_value
from castx.materials.lookup import find_material
from tests.castx.materials.test_origins import ELEMENTS, viscosity_after_hirai

pytestmark = pytest.mark.serial

MOLAR = {"Zn": 65.38e-3, "Al": 26.9815e-3, "Cu": 63.546e-3}
LIQUID = {**ELEMENTS, "Zn": 33.42 / MOLAR["Zn"]}
SHOMATE = {
    "Al": (28.08920, -5.414849, 8.560423, 3.427370, -0.277375),
    "Cu": (17.72891, 28.09870, -31.25289, 13.97243, 0.068611),
}


def solid(element: str, at: float) -> float:
    """Return the heat capacity of an element [J/kg/K] over °C."""
    kelvin = at + 273.15
    if element == "Zn":  # Grønvold and Stølen, from 298.15 to 692.68 K
        return float(np.interp(kelvin, [298.15, 692.68], [25.47, 30.96])) / MOLAR["Zn"]
    t = 1e-3 * kelvin
    a, b, c, d, e = SHOMATE[element]
    return (a + b * t + c * t**2 + d * t**3 + e / t**2) / MOLAR[element]


@pytest.mark.parametrize(
    ("name", "parts", "last"),
    [
        ("ZnAl4Cu1", {"Zn": 0.95, "Al": 0.04, "Cu": 0.01}, 380.0),
        ("CuZn39Pb1Al", {"Cu": 0.6, "Zn": 0.4}, 400.0),
    ],
)
def test_the_heat_of_zinc_alloys_is_that_of_their_metals(name, parts, last) -> None:
    for at, value in database_value(name, ["heat_capacity", "solid"]):
        if at <= last:
            mixed = sum(share * solid(element, at) for element, share in parts.items())
            assert value == pytest.approx(mixed, rel=0.01), at
    mixed = sum(share * LIQUID[element] for element, share in parts.items())
    assert database_value(name, ["heat_capacity", "liquid"]) == pytest.approx(mixed, rel=0.01)


def test_the_latent_heat_of_zinc_alloy_is_that_of_its_metals() -> None:
    """7068, 10 711 and 13 050 J/mol."""
    parts = {"Zn": (0.95, 7068.0), "Al": (0.04, 10711.0), "Cu": (0.01, 13050.0)}
    mixed = sum(share * heat / MOLAR[element] for element, (share, heat) in parts.items())
    assert database_value("ZnAl4Cu1", ["latent_heat"]) == pytest.approx(mixed, rel=0.01)


def test_primary_zinc_freezes_after_scheil() -> None:
    rows = [row for row in database_value("ZnAl4Cu1", ["solid_fraction"]) if row[0] >= 383.0]
    assert len(rows) == 3
    for at, value in rows:
        liquid = ((419.53 - at) / (419.53 - 386.0)) ** (1.0 / (0.22 - 1.0))
        assert value == pytest.approx(1.0 - liquid, abs=1e-3), at


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("ZnAl4Cu1", {"Zn": 0.95, "Al": 0.04, "Cu": 0.01}),
        ("CuZn39Pb1Al", {"Cu": 0.6, "Zn": 0.4}),
    ],
)
def test_the_viscosity_of_molten_zinc_alloys_after_hirai(name, parts) -> None:
    expected = viscosity_after_hirai(name, {MOLAR[key]: share for key, share in parts.items()})
    assert database_value(name, ["melt_viscosity"]) == pytest.approx(expected, rel=0.01)


def test_stainless_steel_has_the_heat_and_conductivity_of_mills() -> None:
    """As fitted up to 1300 °C, and continued."""
    for at, value in database_value("316L", ["heat_capacity", "solid"]):
        assert value == pytest.approx(0.1816 * (at + 273.15) + 428.46, rel=2e-3), at
    for at, value in database_value("316L", ["conductivity", "solid"]):
        t = at + 273.15
        assert value == pytest.approx(-7.301e-6 * t**2 + 0.02716 * t + 6.308, abs=0.06), at


def test_stainless_steel_expands_at_most_as_the_densities_of_mills_say() -> None:
    def density(at: float) -> float:
        t = at + 273.15
        return -4.454e-5 * t**2 - 0.4297 * t + 8089.4

    spread = database_entry("316L").sources["expansion"].spread
    rows = dict(database_value("316L", ["expansion"]))
    by_density = ((density(20.0) / density(1000.0)) ** (1 / 3) - 1.0) / 980.0
    assert spread is not None
    assert spread.high == pytest.approx(by_density / rows[1000], abs=0.01)
    slope = (rows[1000] - rows[500]) / 500.0
    assert rows[1385] == pytest.approx(rows[1000] + 385.0 * slope, rel=0.01)


def test_stainless_steel_shrinks_as_the_densities_of_kim_say() -> None:
    t = database_value("316L", ["liquidus"]) + 273.15
    solid_density = 8084.2 - 0.42086 * t - 3.8942e-5 * t**2
    liquid_density = 7432.7 + 0.039338 * t - 1.8007e-4 * t**2
    found = database_value("316L", ["solidification_shrinkage"])
    assert found == pytest.approx(1.0 - liquid_density / solid_density, abs=5e-4)


def test_molten_stainless_steel_conducts_between_kim_and_its_solid() -> None:
    spread = database_entry("316L").sources["conductivity.liquid"].spread
    at, value = database_value("316L", ["conductivity", "liquid"])[0]
    solid_end = database_value("316L", ["conductivity", "solid"])[-1][1]
    assert spread is not None
    assert spread.low * value == pytest.approx(12.41 + 0.003279 * (at + 273.15), rel=0.02)
    assert spread.high * value == pytest.approx(solid_end, rel=0.02)
    assert value == pytest.approx(0.9 * solid_end, rel=0.02)


@pytest.mark.parametrize("key", ["young_modulus", "yield_stress", "tensile_strength"])
def test_pearlitic_iron_keeps_what_ferritic_iron_keeps(key) -> None:
    ferritic, pearlitic = (dict(database_value(n, [key])) for n in ("GJS-400", "GJS-600"))
    assert set(ferritic) == set(pearlitic)
    for at, value in pearlitic.items():
        assert value / pearlitic[20] == pytest.approx(ferritic[at] / ferritic[20], rel=0.01), at


def test_pearlitic_iron_conducts_less_than_ferritic_iron() -> None:
    ferritic, pearlitic = (
        dict(database_value(n, ["conductivity", "solid"])) for n in ("GJS-400", "GJS-600")
    )
    shares = [1.0 - pearlitic[at] / ferritic[at] for at in ferritic]
    assert 0.015 < min(shares) and max(shares) < 0.095
    spread = database_entry("GJS-600").sources["conductivity.solid"].spread
    assert spread is not None and spread.high * 33.0 > 36.0


@pytest.mark.parametrize(("name", "silicon"), [("AlSi7Mg", 7.0), ("AlSi9Cu3", 9.0)])
def test_latent_heats_of_data_sheets_have_ranges_up_to_what_was_measured(name, silicon) -> None:
    """Xu et al.; Djurdjevic and others lie between."""
    spread = database_entry(name).sources["latent_heat"].spread
    value = database_value(name, ["latent_heat"])
    assert spread is not None and spread.low == value
    assert spread.high == pytest.approx(1e3 * (13.14 * silicon + 372.05), rel=2e-3)
    line = 407.6e3 + (467.5e3 - 407.6e3) * (silicon - 4.85) / 5.0
    assert value < line < spread.high
    stated = {"AlSi7Mg": 433e3, "AlSi9Cu3": 457e3}[name]
    assert line == pytest.approx(stated, rel=2e-3)


def test_measured_latent_heat_of_al_si_7_is_eight_percent_of_its_heat() -> None:
    """What the manual says of a casting poured at 700 °C."""
    alloy = find_material("AlSi7Mg", {})
    hot, solid_end = alloy.enthalpy.enthalpy(np.array([700.0, alloy.solidus]))
    heat = (hot - solid_end) / alloy.density
    for measured, more in ((433e3, 0.08), (464e3, 0.14)):
        assert (measured - alloy.latent_heat) / heat == pytest.approx(more, abs=5e-3)
