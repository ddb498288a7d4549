"""Numbers of the database beside what their sources give, calculated here once more."""

from __future__ import annotations

import numpy as np
import pytest

from castx.input.sourced import UNKNOWN_SOURCE
from castx.materials.database import database_entry, database_names, database_value
from castx.materials.lookup import find_material
from tests.castx.materials.descriptions import table

pytestmark = pytest.mark.serial

# NIST-JANAF: J/mol/K of the liquid (carbon: graphite of 1500 K) over kg/mol.
ELEMENTS = {
    "Al": 31.75104 / 26.9815e-3, "Si": 27.19604 / 28.0855e-3, "Cu": 32.84450 / 63.546e-3,
    "Fe": 46.02400 / 55.845e-3, "C": 23.25 / 12.011e-3,
}  # fmt: skip


@pytest.mark.parametrize("name", database_names())
def test_a_number_without_a_source_has_a_range(name) -> None:
    for key, source in database_entry(name).sources.items():
        if UNKNOWN_SOURCE in source.text and key != "solid_fraction":
            assert source.spread is not None and source.spread.source, key


@pytest.mark.parametrize(
    ("name", "parts", "within"),
    [
        ("AlCu4.5", {"Al": 95.5, "Cu": 4.5}, 0.02),
        ("AlSi7Mg", {"Al": 93.0, "Si": 7.0}, 0.01),
        ("AlSi9Cu3", {"Al": 88.0, "Si": 9.0, "Cu": 3.0}, 0.02),
        ("GJL-250", {"Fe": 94.7, "Si": 2.0, "C": 3.3}, 0.05),
        ("GJS-400", {"Fe": 94.0, "Si": 2.5, "C": 3.5}, 0.05),
    ],
)
def test_the_heat_of_melts_is_that_of_their_elements(name, parts, within) -> None:
    mixed = sum(percent / 100.0 * ELEMENTS[element] for element, percent in parts.items())
    assert database_value(name, ["heat_capacity", "liquid"]) == pytest.approx(mixed, rel=within)


def test_the_viscosity_of_molten_bronze_after_hirai() -> None:
    given = find_material("CuSn12", {}).description
    assert given.solidification_shrinkage is not None
    assert given.density is not None and given.liquidus is not None
    density = given.density * (1.0 - given.solidification_shrinkage)
    molar = 1.0 / (0.88 / 63.546e-3 + 0.12 / 118.71e-3)
    liquidus = given.liquidus + 273.15
    expected = 1.7e-7 * density ** (2 / 3) * liquidus**0.5 * molar ** (-1 / 6)
    assert database_value("CuSn12", ["melt_viscosity"]) == pytest.approx(expected, rel=0.11)


def test_pure_aluminium_creeps_after_frost_and_ashby() -> None:
    """Stress at a rate of 1/s by power-law creep, ε̇ = A D μ b/(k T) (σ/μ)^n."""
    for at, stress in database_value("Al-pure", ["viscosity"])[3:]:
        kelvin = at + 273.15
        modulus = 25.4e9 * (1.0 - 0.5 * (kelvin - 300.0) / 933.0)
        diffusion = 1.7e-4 * np.exp(-142e3 / (8.314 * kelvin))
        rate = 3.4e6 * diffusion * modulus * 2.86e-10 / (1.380649e-23 * kelvin)
        assert stress == pytest.approx(modulus * rate ** (-1.0 / 4.4), rel=0.04), at


@pytest.mark.parametrize(
    ("name", "pure", "key", "base", "within"),
    [
        ("AlCu4.5", "Al-pure", "young_modulus", 20, {400: 0.04, 548: 0.13}),
        ("AlSi7Mg", "Al-pure", "young_modulus", 20, {400: 0.03, 557: 0.10}),
        ("AlSi9Cu3", "Al-pure", "young_modulus", 20, {500: 0.07}),
        ("CuSn12", "Cu-pure", "young_modulus", 20, {600: 0.10}),
        ("AlCu4.5", "Al-pure", "expansion", 100, {548: 0.02}),
        ("AlSi7Mg", "Al-pure", "expansion", 300, {557: 0.03}),
        ("AlSi9Cu3", "Al-pure", "expansion", 300, {500: 0.01}),
        ("CuSn12", "Cu-pure", "expansion", 200, {831: 0.02}),
    ],
)
def test_alloys_change_with_temperature_as_their_metal(name, pure, key, base, within) -> None:
    metal = table(find_material(pure, {}).description, key)
    rows = dict(database_value(name, [key]))
    for at, value in rows.items():
        limit = next((share for end, share in within.items() if at <= end), None)
        if at > base and limit is not None:
            expected = rows[base] * metal(at) / metal(base)
            assert value == pytest.approx(expected, rel=limit), at


def test_structural_steel_softens_after_eurocode_3() -> None:
    """EN 1993-1-2:2005: 0.2 % proof stress, table E.1; effective yield strength, table 3.1."""
    rows = dict(database_value("G20Mn5", ["yield_stress"]))
    for at, factor in {200: 0.89, 400: 0.65, 500: 0.53}.items():
        assert rows[at] == pytest.approx(factor * rows[20], rel=0.07), at
    for at, factor in {600: 0.47, 700: 0.23, 800: 0.11, 900: 0.06, 1000: 0.04}.items():
        assert rows[at] == pytest.approx(factor * rows[20], rel=0.22), at


def test_copper_keeps_of_its_modulus_what_frost_and_ashby_say() -> None:
    for at, value in database_value("Cu-pure", ["young_modulus"])[-2:]:
        kept = 1.0 - 0.54 * (at + 273.15 - 300.0) / 1356.0
        assert value == pytest.approx(124e9 * kept, rel=0.04)


def test_mixtures_of_pure_metals_shrink_alike() -> None:
    aluminium, copper = (
        database_value(n, ["solidification_shrinkage"]) for n in ("Al-pure", "Cu-pure")
    )
    mixed = 0.955 * aluminium + 0.045 * copper
    assert database_value("AlCu4.5", ["solidification_shrinkage"]) == pytest.approx(mixed, rel=0.13)
    assert database_value("CuSn12", ["solidification_shrinkage"]) == pytest.approx(copper, rel=0.13)
