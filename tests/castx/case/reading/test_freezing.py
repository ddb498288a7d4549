"""Where metals freeze by default: alloys that are poured inside cells, others at nodes."""

from __future__ import annotations

from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from tests.coupled_cases import cylinder

pytestmark = pytest.mark.serial


def chosen(material: str = "AlSi7Mg", scheme: str = "iterated", **body) -> str:
    data = cylinder({"coupling": {"scheme": scheme}})
    data["materials"]["solid"] = {"extends": "AlSi7Mg", "liquid": "none"}
    data["bodies"][0] |= {"material": material, **body}
    return read_case(data, Path("case.toml")).bodies[0].freezing


@pytest.mark.parametrize(
    "material",
    [
        "AlSi7Mg", "AlSi9Cu3", "AlSi10Mg", "AlSi12", "GJL-250", "GJS-600", "G20Mn5", "316L",
        "CuSn12", "CuZn39Pb1Al", "ZnAl4Cu1",
    ],
)  # fmt: skip
def test_poured_alloys_freeze_inside_cells(material):
    assert chosen(material, temperature=1600.0) == "cells"


@pytest.mark.parametrize(
    ("material", "body"),
    [
        ("Al-pure", {}),
        ("AlCu4.5", {}),
        ("steel-H13", {"temperature": 20.0}),
        ("AlSi7Mg", {"temperature": 400.0}),
        ("AlSi7Mg", {"feeding": "darcy"}),
        ("AlSi7Mg", {"freezing": "nodes"}),
        ("AlSi7Mg", {"scheme": "thermal"}),
        ("solid", {}),
    ],
)
def test_others_do_at_nodes(material, body):
    assert chosen(material, **body) == "nodes"


def test_a_mould_freezes_at_nodes():
    assert read_case(cylinder(), Path("case.toml")).bodies[1].freezing == "nodes"


@pytest.mark.parametrize(("law", "place"), [("perfect", "nodes"), ("none", "cells")])
def test_an_alloy_in_perfect_contact_freezes_at_nodes(law, place):
    data = cylinder({"interfaces": [{"bodies": ["casting", "mould"], "heat": {"law": law}}]})
    data["bodies"][0]["material"] = "AlSi7Mg"
    casting, mould = read_case(data, Path("case.toml")).bodies
    assert (casting.freezing, mould.freezing) == (place, "nodes")
