"""Materials by name: case before database, extension, and the database itself."""

from __future__ import annotations

import pytest

from castx.errors import CaseError
from castx.materials.description import MaterialDescription
from castx.materials.lookup import LONGEST_CHAIN, find_material
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


def test_without_liquid_the_shrinkage_of_the_parent_is_gone() -> None:
    case = {
        "metal": described(
            liquid={"viscosity": 1e6, "coherency": 0.7}, solidification_shrinkage=0.05
        ),
        "a": part(extends="metal", liquid="none"),
        "b": part(extends="metal", liquid="none", solidification_shrinkage=0.02),
        "c": part(extends="metal", density=2600.0),
    }
    found = [find_material(name, case).description.solidification_shrinkage for name in "abc"]
    assert found == [0.0, 0.02, 0.05]


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


def chained(length: int) -> dict[str, MaterialDescription]:
    """Return materials of which each extends the next, and the last one Al-pure."""
    names = [*(f"m{k}" for k in range(length)), "Al-pure"]
    own = [{"density": 2000 + k, "extends": names[k + 1]} for k in range(length)]
    return {name: part(**given) for name, given in zip(names, own, strict=False)}


def test_a_chain_gives_what_the_nearest_material_says() -> None:
    case = chained(LONGEST_CHAIN)
    case["m3"] = part(extends="m4", latent_heat=3e5, conductivity=99.0)
    case["m7"] = part(extends="m8", latent_heat=2e5)
    found = find_material("m0", case)
    assert (found.density, found.latent_heat) == (2000.0, 3e5)
    assert find_material("m3", case).density == 2004.0
    assert find_material("m5", case).latent_heat == 2e5
    sources = {row.property: row.source for row in found.rows()}
    assert sources["density"] == sources["conductivity"] == "case file"
    assert sources["solidus"] not in ("", "case file")


def test_a_chain_has_an_end() -> None:
    with pytest.raises(CaseError, match="more than 20 materials extend each other; shorten"):
        find_material("m0", chained(LONGEST_CHAIN + 1))
