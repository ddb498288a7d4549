"""Materials by name: case before database, extension, and the database itself."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError
from castx.materials import MaterialDescription, database_entry, database_names, find_material
from castx.materials.database import read_entry
from tests.castx.materials.descriptions import described

pytestmark = pytest.mark.serial


def part(**keys) -> MaterialDescription:
    return MaterialDescription.read(keys)


def test_case_comes_before_the_database() -> None:
    assert find_material("Al-pure", {"Al-pure": described(density=1234.0)}).density == 1234.0
    assert find_material("Al-pure", {}).density == 2702.0


def test_extends_replaces_single_properties() -> None:
    case = {
        "shop": part(extends="AlSi7Mg", density=2650),
        "own": part(extends="shop", solid_fraction="linear", conductivity=150.0),
    }
    own, base = find_material("own", case), find_material("AlSi7Mg", {})
    assert own.name == "own"
    assert own.density == 2650.0
    assert own.latent_heat == base.latent_heat
    assert own.conductivity(20.0, 1.0) == own.conductivity(700.0, 0.0) == 150.0
    sources = {row.property: row.source for row in own.rows()}
    assert sources["density"] == sources["conductivity"] == "case file"
    assert (
        sources["latent_heat"] == {row.property: row.source for row in base.rows()}["latent_heat"]
    )


def test_extending_the_entry_of_the_same_name() -> None:
    case = {"Al-pure": part(extends="Al-pure", density=2600)}
    material = find_material("Al-pure", case)
    assert (material.density, material.latent_heat) == (2600.0, 397e3)


def test_another_law_drops_the_numbers_of_the_old_one() -> None:
    scheil = described(solid_fraction="scheil", partition_coefficient=0.13, melting_point=660.0)
    linear = find_material("a", {"a": part(extends="b", solid_fraction="linear"), "b": scheil})
    assert linear.description.partition_coefficient is None
    table = [[560, 1], [600, 0]]
    tabled = find_material("a", {"a": part(extends="b", solid_fraction=table), "b": scheil})
    assert (tabled.solidus, tabled.liquidus) == (560.0, 600.0)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("Al-puer", r"unknown material 'Al-puer'; known: .*did you mean \"Al-pure\""),
        ("lost", r"materials.lost.extends: unknown material 'nothing'; known: "),
        ("round", r"materials.*extends: a circle: round → trip → round"),
        ("wrong", r"materials.wrong.solidus: 800 °C lies above the liquidus, 610 °C"),
    ],
)
def test_refusals(name, message) -> None:
    case = {
        "lost": part(extends="nothing"),
        "round": part(extends="trip"),
        "trip": part(extends="round"),
        "wrong": part(extends="base", solidus=800),
        "base": described(),
    }
    with pytest.raises(CaseError, match=message):
        find_material(name, case)


def test_database_holds_the_promised_entries() -> None:
    assert {"Al-pure", "AlSi7Mg", "steel-H13", "sand-silica"} <= set(database_names())


@pytest.mark.parametrize("name", database_names())
def test_database_entries_are_complete(name) -> None:
    entry = database_entry(name)
    assert entry.summary
    material = find_material(name, {})
    for row in material.rows():
        assert row.source not in ("", "case file") or row.property == "solid_fraction", row
    for key, source in entry.sources.items():
        value = getattr(entry.description, key.partition(".")[0])
        if hasattr(value, "solid") or hasattr(value, "arguments"):
            assert source.valid is not None and source.valid[0] < source.valid[1], key
    assert material.outside_range(20.0, 500.0) == []
    temperature = np.linspace(20.0, 900.0, 200)
    curve = material.enthalpy
    np.testing.assert_allclose(curve.temperature(curve.enthalpy(temperature)), temperature)


@pytest.mark.parametrize("name", database_names())
def test_database_numbers_are_those_of_solids_and_melts(name) -> None:
    material = find_material(name, {})
    cold = float(material.enthalpy.enthalpy(20.0))
    diffusivity = material.conductivity_at(cold)[0] * material.enthalpy.temperature_slope(cold)
    assert 1e-7 < diffusivity < 2e-4
    if material.young_modulus is not None and material.poisson_ratio is not None:
        assert 4e10 < material.young_modulus(20.0) < 3e11
        assert 0.2 < material.poisson_ratio(20.0) < 0.4
        contraction = material.volumetric_thermal_strain(20.0, 550.0) / 3.0
        assert -0.02 < contraction < -0.005
    if material.melts:
        assert 2e5 < material.latent_heat < 6e5


def test_aluminium_is_isothermal() -> None:
    aluminium = find_material("Al-pure", {})
    assert aluminium.solidus == aluminium.liquidus == pytest.approx(660.3, abs=0.1)
    # H(660.32 °C, liquid) - H(25 °C): 28.69 kJ/mol in the NIST-JANAF tables, 26.98 g/mol
    rise = aluminium.enthalpy.enthalpy(660.323) - aluminium.enthalpy.enthalpy(25.0)
    assert rise / aluminium.density == pytest.approx(28.69e3 / 26.9815e-3, rel=2e-3)


def test_entries_without_source_are_refused() -> None:
    with pytest.raises(CaseError, match="density: needs value and source"):
        read_entry({"density": {"value": 1000}})
