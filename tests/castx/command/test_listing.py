"""Materials and interfaces as people read them in a terminal."""

from __future__ import annotations

import re

import pytest
from rich.console import Console

from castx.command.listing import (
    data_text,
    interface_list,
    interface_table,
    material_list,
    material_table,
    number_text,
)
from castx.materials.database import database_names
from castx.materials.description import MaterialDescription
from castx.materials.inelastic import FLOW_RULES
from castx.materials.lookup import find_material
from castx.transfer.database import interface_entry, interface_names

pytestmark = pytest.mark.serial


def shown(what) -> list[str]:
    console = Console(width=80, file=None, force_terminal=False, soft_wrap=True)
    with console.capture() as capture:
        console.print(what)
    return [line.rstrip() for line in capture.get().splitlines()]


def test_the_list_says_what_data_there_is() -> None:
    lines = shown(material_list({}))
    rows = {line.split()[0]: line for line in lines if line.strip()}
    assert set(database_names()) <= set(rows)
    assert "aluminium" in rows["AlSi9Cu3"] and "500 to 590" in rows["AlSi9Cu3"]
    assert "hepcl" in rows["AlSi9Cu3"] and "1084.62" in rows["Cu-pure"]
    assert "hep··" in rows["steel-H13"] and "h····" in rows["coating-die"]
    assert all(len(line) <= 80 for line in lines[:-1])


@pytest.mark.parametrize(
    ("keys", "letters"),
    [
        ({"density": 1.0}, "·····"),
        ({"density": 1.0, "heat_capacity": 1.0, "conductivity": 1.0}, "h····"),
        ({"law": "norton", "coefficient": 1e-9, "exponent": 2}, "···c·"),
        ({"yield_stress": 1e6, "viscosity": 1e9}, "··pc·"),
    ],
)
def test_letters_of_the_data(keys, letters) -> None:
    case = {"own": MaterialDescription.read(keys)}
    assert data_text(find_material("own", case)) == letters


@pytest.mark.parametrize("law", FLOW_RULES)
def test_a_material_with_the_keys_of_a_rule_creeps(law) -> None:
    rule = FLOW_RULES[law]
    needed = {key: rule.example[key] for key in rule.needed}
    case = {"own": MaterialDescription.read({"law": law, **needed})}
    assert data_text(find_material("own", case)) == "···c·"
    given = {"own": MaterialDescription.read({"law": law, **rule.example})}
    text = " ".join(shown(material_table("own", given)))
    for key in rule.keys:
        unit, factor = (key.shown.unit, key.shown.factor) if key.shown else (key.unit, 1.0)
        value = number_text(factor * rule.example[key.name])
        assert f"{key.name} [1]" in text and f"{value} {unit}".strip() in text


@pytest.mark.parametrize("name", database_names())
def test_all_numbers_fit_a_terminal(name) -> None:
    lines = shown(material_table(name, {}))
    sources = next(index for index, line in enumerate(lines) if line.startswith("[1] "))
    assert all(len(line) <= 80 and "…" not in line for line in lines[1:sources])
    assert lines[0].startswith(f"{name}: ")


def test_tables_carry_units_ranges_and_sources() -> None:
    lines = shown(material_table("AlSi7Mg", {}))
    at = lines.index("conductivity.solid [4]         °C      25  200  400  557")
    assert lines[at + 1] == "  20 to 557 °C                 W/m/K  160  163  155  145"
    assert "density [1]                    2680 kg/m³" in lines
    assert any(line.startswith("young_modulus") for line in lines)
    assert "  20 to 557 °C                 GPa   72   67   58   48" in lines
    assert "[5] representative value, source not established" in lines
    at = lines.index("arm_spacing.coefficient [5]    4e-05 m (K/s)^exponent")
    found = re.fullmatch(r"  2.8e-05 to 5.6e-05 \[(\d+)\]", lines[at + 1])
    assert found is not None and f"[{found[1]}] no source: grain refinement and alloy" in lines
    assert any(line.startswith("  times 0.5 to 2 [") for line in lines)


def test_a_material_of_a_case_shows_what_it_changes() -> None:
    case = {"shop": MaterialDescription.read({"extends": "AlSi7Mg", "density": 2650})}
    lines = shown(material_table("shop", case))
    assert lines[0] == "shop: of the case, extends AlSi7Mg"
    assert "density [1]                    2650 kg/m³" in lines and "[1] case file" in lines
    assert "shop" in " ".join(shown(material_list(case)))


def test_no_source_is_made_up_for_what_is_not_given() -> None:
    """An isothermal change has no law of the solid fraction; a range without one, the default."""
    assert not any("solid_fraction" in line for line in shown(material_table("Al-pure", {})))
    alloy = {"solidus": 500, "liquidus": 600, "latent_heat": 4e5}
    text = shown(material_table("own", {"own": MaterialDescription.read(alloy)}))
    assert any("default of castx" in line for line in text)


def test_the_list_of_interfaces_has_coefficients_closed_and_open() -> None:
    lines = shown(interface_list())
    rows = {line.split()[0]: line.split() for line in lines if line.strip()}
    assert set(interface_names()) <= set(rows)
    gas = 0.05 + 0.5 * 0.0056  # of air between faces of 600 and 300 °C
    opened = 1.0 / (1.0 / 1135 + 1e-4 / gas)
    assert rows["aluminium-steel-coated"][1:3] == ["1135", f"{opened:.3g}"]
    assert all(len(line) <= 80 for line in lines[:-1])


@pytest.mark.parametrize("name", interface_names())
def test_all_numbers_of_an_interface_fit_a_terminal(name) -> None:
    entry, lines = interface_entry(name), shown(interface_table(name))
    sources = next(index for index, line in enumerate(lines) if line.startswith("[1] "))
    assert all(len(line) <= 80 and "…" not in line for line in lines[1:sources])
    assert lines[0] == f"{name}: {entry.summary}"
    for number in entry.numbers:
        assert any(line.startswith(f"{number.name} [") for line in lines)
        assert any(line.endswith(f"] {number.source}") for line in lines[sources:])


def test_interfaces_carry_units_ranges_and_sources() -> None:
    lines = shown(interface_table("aluminium-steel-coating-layer"))
    assert lines[1:3] == ["alloy: aluminium", "mould: steel die"]
    at = lines.index("coating.thickness [3]        100 µm")
    assert lines[at + 1] == "  20 to 500 µm"
    at = lines.index("roughness [2]                50, 50 µm")
    assert lines[at + 1] == "  10 to 100, 25 to 100 µm"
    at = lines.index("gas_conductivity [5]         °C         20     100     200     300     400")
    under = "  0.024 to 0.085             W/m/K  0.0257  0.0314   0.038  0.0441    0.05"
    assert lines[at + 1] == under
