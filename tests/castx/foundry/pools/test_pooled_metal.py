"""What pools ask of a case: limit, shrinkage and surfaces that feed."""

from __future__ import annotations

from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from castx.foundry.pools.feeding_surfaces import FeedingSurfaces
from castx.foundry.pools.pooled_metal import pooled_metals
from castx.input.toml_text import parse_toml

pytestmark = pytest.mark.serial

FACING = {"casting/mould": "mould"}
CASE = """
[geometry]
generator = "cylinder_in_mould"
model = "axisymmetric"
radius = 0.02
height = 0.04
wall = 0.01
size = 4e-3
[[bodies]]
name = "casting"
material = "metal"
temperature = 640
[[bodies]]
name = "mould"
material = "steel-H13"
temperature = 200
[[interfaces]]
bodies = ["casting", "mould"]
heat = { law = "constant", closed = 1000 }
[[boundaries]]
on = "casting/base"
displacement = { z = 0 }
[time]
end = 1
[materials.metal]
extends = "AlSi7Mg"
"""


def metals(**foundry):
    content = parse_toml(CASE)
    content["foundry"] = foundry
    return pooled_metals(read_case(content, Path("case.toml")))


def test_limit_and_surfaces_follow_from_the_case():
    found = metals()
    assert list(found) == ["casting"]
    own = found["casting"]
    assert own.surfaces == FeedingSurfaces(None, ("base",), FACING)
    assert own.surfaces.closed(["casting/mould"]) == {"base", "mould"}
    assert own.surfaces.closed([]) == {"base"}
    assert metals(pool_limit=0.4)["casting"].limit == 0.4
    named = metals(feeders=["casting/top"])["casting"].surfaces
    assert named == FeedingSurfaces(("top",))


def test_limit_and_shrinkage_follow_from_the_material():
    for liquid, limit in (({"viscosity": 1e6, "coherency": 0.62}, 0.62), ("none", 0.7)):
        content = parse_toml(CASE)
        content["materials"]["metal"] |= {"liquid": liquid, "solidification_shrinkage": 0.06}
        own = pooled_metals(read_case(content, Path("case.toml")))["casting"]
        assert (own.limit, own.shrinkage) == (limit, 0.06)
