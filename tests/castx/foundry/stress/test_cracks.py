"""Which bodies of a case are followed against tearing and cracking, and what is saved of them."""

from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from castx.foundry.stress.cracks import FreezingMetal, cracks_of
from castx.materials.lookup import find_material
from tests.castx.fakes import cylinder_mesh
from tests.coupled_cases import ALUMINIUM, STEEL, cylinder

pytestmark = pytest.mark.serial

ALLOY = {**ALUMINIUM, "solidus": 600.0, "tensile_strength": 2e8}


def followed(comm, *fields, **changes):
    materials = {"aluminium": ALLOY, "steel": {**STEEL, **changes.pop("steel", {})}}
    content = cylinder({"materials": materials, "output": {"fields": list(fields)}, **changes})
    return cracks_of(read_case(content, Path("case.toml")), cylinder_mesh(comm))


def test_only_what_is_asked_for_is_followed(comm):
    none = followed(comm, "temperature")
    assert none.strains("casting") is None and none.cold_crack_index("casting") is None
    strained = followed(comm, "brittle_strain")
    assert strained.strains("casting") and strained.strains("mould") is None
    assert strained.cold_crack_index("casting") is None
    cracked = followed(comm, "cold_crack_index")
    assert cracked.strains("casting") is None
    assert cracked.cold_crack_index("casting") is not None
    assert cracked.cold_crack_index("mould") is None
    both = followed(comm, "cold_crack_index", steel={"tensile_strength": 1e9})
    assert both.cold_crack_index("mould") is not None
    names = set(both.saved())
    assert names == {"cold/casting/index", "cold/mould/index"}


def test_bodies_whose_temperature_is_given_are_followed_by_it():
    alloy = find_material("AlSi7Mg", {})
    by_enthalpy, by_temperature = (FreezingMetal.of(alloy, given) for given in (False, True))
    assert (by_enthalpy.name, by_temperature.name) == ("enthalpy", "temperature")
    assert list(by_enthalpy.windows) == [0.95, 0.98, 0.99]
    assert by_enthalpy.windows[0.95].begin > 1e6 > by_temperature.windows[0.95].begin
