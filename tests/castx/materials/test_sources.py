"""Properties of a material with unit, source and range, and which of them leave their range."""

from __future__ import annotations

import pytest

from castx.materials.description import MaterialDescription
from castx.materials.inelastic import FLOW_RULES, HARDENING_RULES, LIQUID_RULES
from castx.materials.sources import Property, PropertyRow, Source, properties, unit_of
from tests.castx.materials.descriptions import alloy, described

pytestmark = pytest.mark.serial

NORTON = {"law": "norton", "coefficient": 1e-40, "exponent": 5}


def test_outside_range_looks_at_each_phase_where_it_is() -> None:
    material = alloy(heat_capacity={"solid": [[20, 900], [550, 1000]], "liquid": 1200.0})
    assert material.outside_range(100.0, 500.0) == []
    names = [entry.property for entry in material.outside_range(50.0, 700.0)]
    assert names == ["conductivity.solid", "expansion"]
    wet = alloy(conductivity={"solid": 160.0, "liquid": [[600, 80], [650, 85]]}, expansion=2e-5)
    assert wet.outside_range(20.0, 640.0) == []
    (entry,) = wet.outside_range(20.0, 700.0)
    assert entry[:2] == ("conductivity.liquid", (600.0, 650.0)) and entry.beyond() == 50.0
    (entry,) = material.outside_range(50.0, 400.0)
    assert entry == ("expansion", (100.0, 500.0), (50.0, 400.0)) and entry.beyond() == 50.0


def test_rows_hold_every_number() -> None:
    rows = alloy(expansion_reference="20 degC", young_modulus=[["20 degC", "70 GPa"]]).rows()
    assert PropertyRow("density", None, 2500.0, "kg/m³", "case file") in rows
    assert PropertyRow("conductivity.solid", 500.0, 160.0, "W/m/K", "case file") in rows
    assert PropertyRow("solid_fraction", None, "linear", "", "default of castx") in rows
    assert PropertyRow("young_modulus", None, 70e9, "Pa", "case file") in rows
    assert sum(row.property == "expansion" for row in rows) == 2


def test_rows_show_what_is_given() -> None:
    hardening = {"linear": 1e9, "saturation": 5e7, "rate": 10}
    keys = {"yield_stress": [[20, 6e7], [500, 1e7]], "hardening": hardening, "dissipation": 0.5}
    liquid = {"model": "norton", "coefficient": 1e-8, "exponent": 2, "coherency": 0.7}
    rows = {
        (row.property, row.temperature): (row.value, row.unit)
        for row in alloy(**keys, **NORTON, liquid=liquid, solidification_shrinkage=0.05).rows()
    }
    assert rows["yield_stress", 500.0] == (1e7, "Pa")
    assert rows["hardening.saturation", None] == (5e7, "Pa")
    assert rows["hardening.rate", None] == (10.0, "")
    assert rows["law", None] == ("norton", "")
    assert rows["coefficient", None] == (1e-40, "1/(s Pa^exponent)")
    assert rows["dissipation", None] == (0.5, "")
    assert rows["liquid.model", None] == ("norton", "")
    assert rows["liquid.exponent", None] == (2.0, "")
    assert rows["solidification_shrinkage", None] == (0.05, "")
    defaults = {"activation_energy", "liquid.activation_energy", "kinematic_hardening", "viscosity"}
    assert not defaults & {name for name, _ in rows}
    assert not any(row.property in ("law", "dissipation", "exponent") for row in alloy().rows())


def test_yield_stress_has_a_range() -> None:
    material = alloy(yield_stress=[[100, 6e7], [600, 1e7]])
    names = [entry.property for entry in material.outside_range(50.0, 400.0)]
    assert names == ["expansion", "yield_stress"]


@pytest.mark.parametrize(
    ("name", "unit"),
    [("density", ("kg/m³", "kg/m³", 1.0)), ("conductivity.liquid", ("W/m/K", "W/m/K", 1.0)),
     ("solidus", ("°C", "°C", 1.0)), ("young_modulus", ("Pa", "GPa", 1e-9)),
     ("yield_stress", ("Pa", "MPa", 1e-6)), ("hardening", ("Pa", "MPa", 1e-6)),
     ("hardening.rate", ("", "", 1.0)), ("expansion", ("1/K", "µm/m/K", 1e6)),
     ("latent_heat", ("J/kg", "kJ/kg", 1e-3)), ("law", ("", "", 1.0)),
     ("viscosity", ("Pa s^(1/exponent)", "MPa s^(1/n)", 1e-6)),
     ("liquid.viscosity", ("Pa s", "Pa s", 1.0)), ("liquid.coherency", ("", "", 1.0)),
     ("liquid.activation_energy", ("J/mol", "kJ/mol", 1e-3))],
)  # fmt: skip
def test_units(name, unit) -> None:
    assert unit_of(name) == unit


def test_every_key_of_every_rule_has_its_unit() -> None:
    for rule in FLOW_RULES.values():
        for key in rule.keys:
            unit = unit_of(key.name)
            assert unit is not None and unit.si == key.unit, (rule.name, key.name)
            assert rule.name not in LIQUID_RULES or unit_of(f"liquid.{key.name}") == unit
    for hardening in HARDENING_RULES:
        for key in hardening.keys:
            unit = unit_of("hardening." * hardening.isotropic + key.name)
            assert unit is not None and unit.si == key.unit, (hardening.name, key.name)
    assert unit_of("extends") is unit_of("price") is None


def test_properties_stand_in_the_order_of_the_case_format() -> None:
    keys = {"yield_stress": 1e8, "hardening": 1e9, "kinematic_hardening": 1e9, "viscosity": 1e8,
            "exponent": 3, "law": "perzyna", "dissipation": 0.8}  # fmt: skip
    names = [item.name for item in alloy(**keys).properties()]
    flow = ["yield_stress", "hardening.linear", "kinematic_hardening", "law", "viscosity",
            "exponent", "dissipation"]  # fmt: skip
    assert names[-len(flow) :] == flow


def test_a_source_of_the_whole_is_that_of_its_parts() -> None:
    sources = {"hardening": Source("table 3", (20.0, 400.0)), "density": Source("table 1")}
    description = described(yield_stress=1e8, hardening=1e9)
    found = {item.name: item for item in properties(description, sources)}
    assert found["hardening.linear"] == Property(
        "hardening.linear", found["hardening.linear"].value, "Pa", "table 3", (20.0, 400.0)
    )
    assert found["density"].source == "table 1" and found["density"].valid is None
    assert found["latent_heat"].source == "case file"


def test_a_table_holds_between_its_ends() -> None:
    description = MaterialDescription.read({"young_modulus": [[20, 70e9], [500, 40e9]]})
    (item,) = properties(description, {})
    assert item.valid == (20.0, 500.0)
