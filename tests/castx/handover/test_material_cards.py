"""Material cards hold the numbers of the material at its temperatures."""

import pytest

from castx.errors import CaseError
from castx.handover.material_cards import flows, material_cards
from castx.materials.description import MaterialDescription
from castx.materials.lookup import find_material
from tests.castx.handover.made_results import MATERIAL

pytestmark = pytest.mark.serial


def material(**changes):
    description = MaterialDescription.read({**MATERIAL, **changes})
    return find_material("metal", {"metal": description})


def card(lines, name):
    lines = list(lines)
    start = next(i for i, line in enumerate(lines) if line.startswith(name))
    rows = []
    for line in lines[start + 1 :]:
        if line.startswith("*"):
            break
        rows.append([float(value) for value in line.split(",")])
    return lines[start], rows


def test_elasticity_and_expansion_are_tables_over_temperature():
    lines = list(material_cards(material(), "METAL", "thermo-elastic"))
    assert lines[0] == "*MATERIAL, NAME=METAL"
    rows = card(lines, "*ELASTIC")[1]
    assert rows[-2:] == [[70e9, 0.33, 20.0], [50e9, 0.33, 400.0]]
    heading, rows = card(lines, "*EXPANSION")
    assert heading == "*EXPANSION, ZERO=20" and rows == [[2.1e-5, 20.0], [2.4e-5, 400.0]]
    assert not any(line.startswith("*PLASTIC") for line in lines)


def test_straight_hardening_is_two_rows_for_each_temperature():
    rows = card(material_cards(material(), "METAL", "thermo-elasto-plastic"), "*PLASTIC")[1]
    assert rows == [
        [100e6, 0.0, 20.0], [1.1e9, 1.0, 20.0], [40e6, 0.0, 400.0], [1.04e9, 1.0, 400.0],
    ]  # fmt: skip


def test_curved_hardening_is_a_table_that_ends_at_saturation():
    curved = material(hardening={"saturation": 50e6, "rate": 20.0})
    rows = card(material_cards(curved, "METAL", "thermo-elasto-plastic"), "*PLASTIC")[1]
    cold = [row for row in rows if row[2] == 20.0]
    assert cold[0][:2] == [100e6, 0.0] and len(cold) > 5
    assert cold[-1][0] == pytest.approx(150e6, rel=1e-6)


def test_a_strength_takes_the_place_of_the_yield_stress():
    lines = material_cards(material(), "METAL", "thermo-elasto-plastic", 123e6)
    assert card(lines, "*PLASTIC")[1] == [[123e6, 0.0, 20.0], [1.123e9, 1.0, 20.0]]


def test_the_solid_alone_is_tabled():
    melting = material(
        solidus=300, liquidus=350, latent_heat=4e5, yield_stress=[[20, 1e8], [400, 0]]
    )
    lines = list(material_cards(melting, "METAL", "thermo-elasto-plastic"))
    assert max(row[2] for row in card(lines, "*ELASTIC")[1]) == 300.0
    assert max(row[2] for row in card(lines, "*PLASTIC")[1]) == 300.0


def test_a_material_without_yield_stress_does_not_flow():
    assert flows(material(), "thermo-elasto-viscoplastic")
    assert not flows(material(), "thermo-elastic")


def test_missing_elastic_constants_are_refused():
    given = {key: value for key, value in MATERIAL.items() if key != "young_modulus"}
    description = MaterialDescription.read(given)
    with pytest.raises(CaseError, match="young_modulus and poisson_ratio for CalculiX"):
        list(material_cards(find_material("metal", {"metal": description}), "M", "thermo-elastic"))
