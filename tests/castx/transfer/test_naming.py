"""Entries that a heat transfer names, and keys given beside them."""

from __future__ import annotations

import pytest

from castx.case.heat_transfer import InterfaceHeat
from castx.input.problems import Refusal
from castx.report.interface_law import heat_transfer_coefficient
from castx.transfer.database import interface_entry, interface_names
from castx.transfer.naming import changed, with_entry

pytestmark = pytest.mark.serial

LAYER = "aluminium-steel-coating-layer"
COATED = "aluminium-steel-coated"
OPEN = {"over": "gap", "table": [[0, 2000], [1e-4, 400]]}


def coefficient(gap: float = 0.0, **heat: object) -> float:
    return float(heat_transfer_coefficient(heat, gap=gap))


def test_keys_beside_the_name_change_those_of_the_entry():
    entry = interface_entry(COATED).heat
    assert with_entry({"from": COATED}) == {"from": COATED, **entry}
    assert with_entry({"law": "none"}) == {"law": "none"}
    own = with_entry({"from": COATED, "closed": 300, "transition": 1e-5})
    assert own == {"from": COATED, **entry, "closed": 300, "transition": 1e-5}


@pytest.mark.parametrize(
    "heat, taken, left_out",
    [
        ({"from": LAYER, "closed": 900}, {"law", "closed"}, {"roughness", "coating"}),
        ({"from": COATED, "coating": {"thickness": 1e-4, "conductivity": 0.4}}, {"coating"},
         {"closed"}),
        ({"from": COATED, "roughness": [1e-5, 1e-5]}, {"roughness"}, {"closed"}),
        ({"from": COATED, "law": "constant"}, {"closed", "radiation"}, set()),
        ({"from": COATED, "law": "none"}, {"radiation"}, {"closed", "gas_conductivity"}),
        ({"from": COATED, "law": "perfect"}, set(), {"closed", "gas_conductivity", "radiation"}),
        ({"from": COATED, "law": "limited", "open": OPEN}, {"open"}, {"gas_conductivity"}),
        ({"from": LAYER, "law": "limited", "open": OPEN}, {"open", "gas_conductivity"}, set()),
        ({"from": COATED, "law": "solid-fraction", "open": 80}, {"open"}, {"gas_conductivity"}),
        ({"from": LAYER, "law": "solid-fraction", "open": 80}, {"open", "gas_conductivity"}, set()),
        ({"from": LAYER, "law": "constant", "closed": 80}, {"closed"}, {"gas_conductivity"}),
        ({"from": COATED, "pressure": {"hardness": 1e9}, "roughness": [1e-5, 1e-5]},
         {"closed", "roughness", "pressure"}, set()),
    ],
)  # fmt: skip
def test_what_a_change_replaces_is_left_out_and_the_rest_is_accepted(heat, taken, left_out):
    keys = with_entry(heat)
    assert taken <= set(keys) and not left_out & set(keys)
    assert with_entry(keys) == keys
    described = InterfaceHeat.read(heat)
    assert described.entry == heat["from"] and described.law == keys["law"]


def test_single_keys_of_a_coating_are_changed():
    keys = with_entry({"from": LAYER, "coating": {"thickness": 2e-4}})
    assert keys["coating"] == {**interface_entry(LAYER).heat["coating"], "thickness": 2e-4}
    read = InterfaceHeat.read({"law": "constant", "coating": {"thickness": 1, "conductivity": 2}})
    assert changed({"coating": read.coating}, {"coating": {"thickness": 3}}) == {
        "coating": {"thickness": 3, "conductivity": 2.0}
    }


def test_gas_beside_a_patch_replaces_the_open_gap():
    base = {"law": "limited", "closed": 500, "open": OPEN}
    assert changed(base, {"gas_conductivity": 0.05}) == {
        "law": "limited", "closed": 500, "gas_conductivity": 0.05
    }  # fmt: skip


def test_changes_change_the_coefficient():
    base = coefficient(**{"from": LAYER})
    depth, gas = 0.5 * 2**0.5 * 50e-6, 0.05 + 0.5 * 0.0056  # of air at the mean, 450 °C
    assert base == pytest.approx(1.0 / (depth / gas + 100e-6 / 0.3))
    assert coefficient(**{"from": LAYER, "coating": {"thickness": "200 um"}}) < 0.8 * base
    assert coefficient(**{"from": LAYER, "roughness": [0, 0]}) == pytest.approx(3000.0)
    assert coefficient(**{"from": LAYER, "closed": 900}) == 900.0
    helium = coefficient(gap=1e-4, **{"from": COATED, "gas_conductivity": 0.25})
    assert helium == pytest.approx(1.0 / (1.0 / 1135 + 1e-4 / 0.25))
    assert helium > 2.0 * coefficient(gap=1e-4, **{"from": COATED})


def test_unknown_names_are_refused():
    with pytest.raises(Refusal, match=r'from: no such interface; .*did you mean "steel-sand"'):
        with_entry({"from": "steel-snad"})
    with pytest.raises(Refusal, match="from: no such interface; known: aluminium-chill-copper"):
        with_entry({"from": ["steel-sand"]})


@pytest.mark.parametrize("name", interface_names())
def test_every_entry_changes_by_every_law_or_closed(name):
    assert InterfaceHeat.read({"from": name, "closed": 321}).given.values["closed"].table(0) == 321
    assert InterfaceHeat.read({"from": name, "law": "constant"}).law == "constant"
