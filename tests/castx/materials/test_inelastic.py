"""The keys of yielding, hardening and creep: units, tables, what is refused and what is shown."""

from __future__ import annotations

import pickle
import random
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path

import pytest

from bench.robustness import casting, toml
from castx.case.reading.read import read_case
from castx.errors import CaseError
from castx.materials.description import MaterialDescription
from castx.materials.flow import VISCOPLASTIC
from castx.materials.inelastic import (
    DEFAULT_LAW,
    FLOW_RULES,
    HARDENING_RULES,
    LIQUID_RULES,
    rule_table,
    rules_with,
)
from castx.materials.lookup import find_material
from castx.materials.rules.declaration import Rule
from castx.materials.rules.flow_rule import FlowRule
from castx.materials.rules.key import PeoplesUnit
from tests.castx.materials.descriptions import described, table

pytestmark = pytest.mark.serial

NORTON = {"law": "norton", "coefficient": 1e-40, "exponent": 5}
LIQUID = {"coherency": 0.7}
ENERGY = "activation_energy"
PROJECT = Path(__file__).parents[3]
HARDENING = [rule.name for rule in HARDENING_RULES]
RULES: tuple[Rule, ...] = (*FLOW_RULES.values(), *HARDENING_RULES)


KEYS_OF_HARDENING = re.escape(
    ", or ".join(
        " and ".join(key.name for key in rule.keys) + (f" ({rule.title})" if rule.title else "")
        for rule in HARDENING_RULES
        if rule.isotropic
    )
)


def users(key: str, rules: Mapping[str, FlowRule]) -> str:
    """Return the rules that read a key, as messages name them."""
    return " or ".join(f'"{rule}"' for rule in rules_with(key, rules))


def test_rules_with_a_key() -> None:
    assert {"perzyna", "norton"} <= set(rules_with("exponent", FLOW_RULES))
    assert rules_with("viscosity", FLOW_RULES)[:2] == ["perzyna", "bingham"]
    assert "perzyna" not in rules_with("exponent", LIQUID_RULES)


def test_quantities_carry_units() -> None:
    material = described(
        law="bingham",
        yield_stress=[["20 degC", "60 MPa"], [550, 0]],
        hardening={"linear": "1 GPa", "saturation": [[20, "50 MPa"]], "rate": 12},
        kinematic_hardening="2 GPa",
        viscosity="3 GPa*s",
        dissipation="80 %",
        solidification_shrinkage="6.5 %",
    )
    assert material.yield_stress is not None
    assert material.yield_stress(285.0) == pytest.approx(30e6)
    assert table(material.hardening, "linear")(20.0) == pytest.approx(1e9)
    assert table(material.hardening, "saturation")(20.0) == pytest.approx(50e6)
    assert table(material.hardening, "rate")(20.0) == 12.0
    assert table(material, "kinematic_hardening")(20.0) == pytest.approx(2e9)
    assert table(material, "viscosity")(20.0) == pytest.approx(3e9)
    assert material.dissipation == pytest.approx(0.8)
    assert material.solidification_shrinkage == pytest.approx(0.065)
    creeping = described(**NORTON, activation_energy="140 kJ/mol")
    assert table(creeping, "activation_energy")(20.0) == pytest.approx(1.4e5)


def test_defaults() -> None:
    material = described()
    assert (material.law, material.dissipation) == ("perzyna", 0.9)
    needed = ("yield_stress", "viscosity", "coefficient")
    assert [getattr(material, key) for key in needed] == [None] * 3
    assert table(material, "exponent")(20.0) == 1.0
    assert not material.hardening.acts and not table(material, "kinematic_hardening").values.any()
    assert material.solidification_shrinkage == table(material, "activation_energy")(20.0) == 0.0


@pytest.mark.parametrize(
    "viscosity", ["2 MPa*s", [[20, "2 MPa*s"], [500, 1e6]], [[20, 2e6], [500, "1e6 Pa*s"]]]
)
def test_a_viscosity_with_unit_needs_a_linear_law(viscosity) -> None:
    described(viscosity=viscosity)
    described(viscosity=viscosity, exponent=1)
    described(viscosity=viscosity, law="bingham")
    with pytest.raises(CaseError, match=r"^viscosity: a unit of Pa·s fits exponent 1 only; give"):
        described(viscosity=viscosity, exponent=[[20, 1], [500, 2]])
    case = {
        "base": described(viscosity=viscosity),
        "steep": MaterialDescription.read({"extends": "base", "exponent": 4}),
    }
    with pytest.raises(CaseError, match=r"materials.steep.viscosity: a unit of Pa·s"):
        find_material("steep", pickle.loads(pickle.dumps(case)))
    described(viscosity=2e6, exponent=4)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"law": "prezyna"}, r"^law: unknown; .*did you mean \"perzyna\""),
        ({"viscosity": "3 Pa"}, r"^viscosity: 'Pa' is not a unit of viscosity"),
        ({"viscosity": [[20, 0]]}, r"^viscosity\[0\]: must be positive"),
        ({"exponent": [[20, 1], [90, -1]]}, r"^exponent\[1\]: must be positive"),
        (NORTON | {"coefficient": 0}, r"^coefficient: must be positive"),
        (NORTON | {"coefficient": "1e-40 1/s"}, r"^coefficient: a plain number in 1/\(s\*Pa\^n\)"),
        (NORTON | {"activation_energy": -1}, r"^activation_energy: must be at least 0"),
        (NORTON | {"activation_energy": "1 J/kg"}, r"^activation_energy: 'J/kg' is not a unit"),
        (
            NORTON | {"viscosity": 1e9},
            rf"^viscosity: acts only with law = {users('viscosity', FLOW_RULES)}, and here",
        ),
        (
            {"coefficient": 1e-40},
            rf"^coefficient: acts only with law = {users('coefficient', FLOW_RULES)}, and here it",
        ),
        (
            {"activation_energy": 1e5},
            rf"^activation_energy: acts only with law = {users(ENERGY, FLOW_RULES)}",
        ),
        (
            {"law": "bingham", "viscosity": 1e9, "exponent": 2},
            rf"^exponent: acts only with law = {users('exponent', FLOW_RULES)}, .* \"bingham\"",
        ),
        ({"yield_stress": -1}, r"^yield_stress: must be at least 0"),
        ({"hardening": [[20, 1e9], [90, -1]]}, r"^hardening\[1\]: must be at least 0"),
        ({"hardening": {}}, f"^hardening: needs {KEYS_OF_HARDENING}$"),
        ({"hardening": {"saturation": 1e8}}, r"^hardening.rate: missing; .*with saturation"),
        ({"hardening": {"rate": 5}}, r"^hardening.saturation: missing; .*with rate"),
        ({"hardening": {"saturation": 1e8, "rate": 0}}, r"^hardening.rate: must be positive"),
        ({"hardening": {"modulus": 1e8}}, r"^hardening.modulus: unknown key; .*linear"),
        ({"hardening": 1e9}, r"^hardening: acts only with yield_stress; add it"),
        ({"kinematic_hardening": 1e9}, r"^kinematic_hardening: acts only with yield_stress"),
        ({"yield_stress": 1e8, "kinematic_hardening": -1}, r"^kinematic_hardening: must be"),
        ({"dissipation": 1.1}, r"^dissipation: must be at least 0 and at most 1"),
        ({"solidification_shrinkage": -1}, r"^solidification_shrinkage: must be above -1"),
        (
            {"solidus": None, "liquidus": None, "latent_heat": None, "heat_capacity": 900,
             "conductivity": 90, "solidification_shrinkage": 0.05},
            r"^solidification_shrinkage: acts only in a material that melts",
        ),
        ({"liquid": LIQUID}, r"^liquid.viscosity: missing; model = \"viscous\" needs it"),
        (
            {"liquid": LIQUID | {"model": "norton"}},
            r"^liquid.coefficient: missing; model = \"norton\" needs it",
        ),
        (
            {"liquid": LIQUID | {"viscosity": 1e6, "exponent": 2}},
            rf"^liquid.exponent: acts only with model = {users('exponent', LIQUID_RULES)}, and ",
        ),
        (
            {"liquid": LIQUID | {"model": "norton", "coefficient": 1e-8, "viscosity": 1e6}},
            r"^liquid.viscosity: acts only with model = \"viscous\", and here it is \"norton\"",
        ),
        ({"liquid": LIQUID | {"model": "newton"}}, r"^liquid.model: unknown"),
    ],
)  # fmt: skip
def test_refusals(changes, message) -> None:
    with pytest.raises(CaseError, match=message):
        described(**changes)


def test_data_of_another_law_of_the_body_is_no_mistake() -> None:
    material = described(**NORTON, yield_stress=5e7, hardening=1e9, kinematic_hardening=1e9)
    assert material.hardening.acts


def test_a_new_law_takes_the_numbers_of_the_old_one_away() -> None:
    case = {
        "creeping": described(**NORTON, activation_energy=1e5, yield_stress=5e7),
        "linear": MaterialDescription.read(
            {"extends": "creeping", "law": "bingham", "viscosity": 1e9}
        ),
        "hotter": MaterialDescription.read({"extends": "creeping", "coefficient": 1e-39}),
        "same": MaterialDescription.read({"extends": "creeping", "law": "norton"}),
    }
    linear = find_material("linear", case).description
    assert linear.law == "bingham" and table(linear, "exponent")(20.0) == 1.0
    assert not {"coefficient", "exponent"} & linear.model_fields_set
    assert linear.yield_stress is not None
    for name in ("hotter", "same"):
        material = find_material(name, case).description
        assert (material.law, table(material, "exponent")(20.0)) == ("norton", 5.0)
        assert table(material, "activation_energy")(20.0) == 1e5


def test_every_file_is_a_rule() -> None:
    for folder, rules in (("flow_rules", FLOW_RULES), ("hardening", HARDENING)):
        files = (PROJECT / "castx/materials" / folder).glob("[!_]*.py")
        assert {file.stem for file in files} == {name.replace("-", "_") for name in rules}


def test_tables_of_rules_have_a_row_for_each() -> None:
    rows = {row.name: row for row in rule_table(FLOW_RULES.values())}
    assert list(rows) == list(FLOW_RULES) and next(iter(rows)) == "perzyna"
    assert rows["norton"].keys == (
        "coefficient [1/(s Pa^exponent)]", "exponent = 1", "activation_energy [J/mol] = 0",
    )  # fmt: skip
    assert [row.name for row in rule_table(HARDENING_RULES)] == sorted(HARDENING)
    assert {"linear", "prager", "voce"} <= set(HARDENING)
    for row in (*rows.values(), *rule_table(HARDENING_RULES)):
        assert row.summary.endswith(".") and row.formula and row.source


@pytest.mark.parametrize(
    "rule, key",
    [(rule, key) for rule in RULES for key in rule.keys],
    ids=lambda value: value.name,
)
def test_keys_of_rules_are_not_negative_and_people_read_stresses_in_megapascal(rule, key) -> None:
    with pytest.raises(CaseError, match=r"must be (positive|at least 0)"):
        key.entry.read(-rule.example[key.name])
    assert key.unit != "Pa" or key.shown == PeoplesUnit("MPa", 1e-6), f"shown of {key.name}"


@pytest.mark.parametrize("law", FLOW_RULES)
def test_every_flow_rule_stands_in_a_notebook_and_in_the_random_castings(law) -> None:
    notebooks = "".join(path.read_text() for path in (PROJECT / "demos").glob("*_notebook.py"))
    shown = "in castx.flow_rules().items()" in notebooks or f"`{law}`" in notebooks
    assert shown, f"no notebook in demos shows the flow rule {law!r}"
    drawn = [casting(random.Random(f"1/{number}")) for number in range(200)]
    laws = {material["law"] for case in drawn for material in case.get("materials", {}).values()}
    flowing = any(case["bodies"][0]["law"] == VISCOPLASTIC for case in drawn)
    assert law in laws or (law == DEFAULT_LAW and flowing), f"bench/robustness.py draws no {law!r}"


def test_a_random_casting_that_creeps_can_be_read() -> None:
    drawn = (casting(random.Random(f"1/{number}")) for number in range(200))
    case = next(case for case in drawn if "materials" in case)
    read = read_case(tomllib.loads("\n".join(toml(case))), Path("random"))
    (name,) = read.materials
    assert find_material(name, read.materials).description.law in FLOW_RULES
