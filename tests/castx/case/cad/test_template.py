"""First case files are accepted, and their choices follow from names."""

from __future__ import annotations

import tomllib
from dataclasses import replace

import pytest

from castx.case.cad.template import CASTING, CHILL, MOULD, SAND, NewCase, case_text, roles
from castx.case.reading.read import load_case

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    "names, expected",
    [
        (["casting", "mould"], [CASTING, MOULD]),
        (["die-left", "Part 1", "core"], [MOULD, CASTING, SAND]),
        (["solid-1", "solid-2"], [CASTING, MOULD]),
        (["housing", "feeder"], [MOULD, CASTING]),
        (["Chill-1", "block", "drag", "cope"], [CHILL, CASTING, MOULD, MOULD]),
        (["core"], [CASTING]),
    ],
)
def test_roles_by_names(names, expected):
    assert list(roles(names).values()) == expected


def assembly(*free: tuple[str, float], margin=None):
    bodies = (("solid-1", 2e-6), ("core-2", 1e-6), ("chill", 1e-6), ("solid-4", 1e-6))
    return NewCase("a.step", 5e-3, margin, bodies, (("solid-1", "core-2", 3e-4),), free)


def test_what_solids_are_taken_for_is_told():
    (told,) = assembly(("solid-1/outside", 2e-4)).taken_for()
    words = "solid-1: cast, core-2: a core, chill: a chill, solid-4: of the mould;"
    assert told.startswith(f"by their names and their order, {words} name them in CAD (core,")
    (made,) = assembly(margin=0.01).taken_for()  # in a block that is made round it
    assert "core-2: a core, chill: a chill, solid-4: a core; name them in CAD" in made
    lone = NewCase("a.step", 5e-3, 0.01, (("solid-1", 2e-6), ("mould", 1e-6)), (), ())
    assert lone.drawn == ("solid-1",) and list(lone.taken_for()) == []


def test_a_casting_without_a_mould_is_told():
    bare = assembly(("solid-1/outside", 4e-4), ("solid-1/top", 2e-4), ("core-2/outside", 1.0))
    _, told = bare.taken_for()
    assert told.startswith("67 % of the surface of solid-1 is bare: the mould of the file is not")
    assert bare.bare() == ("solid-1",) and not bare.has_mould
    assert replace(bare, bodies=(*bare.bodies, ("Die left", 1e-6))).has_mould


def test_the_text_is_a_case():
    case = NewCase(
        "../my part.step",
        0.0051,
        0.03,
        (("core-1", 1e-6), ("casting", 2e-6), ("core-2", 1e-6), ("mould", 3e-6)),
        (("core-1", "casting", 1e-4), ("mould", "casting", 2e-4), ("core-1", "core-2", 1e-5)),
        (("mould/outside", 3e-4),),
    )
    text = case_text(case)
    read = load_case(tomllib.loads(text))
    assert read.geometry.cad is not None and read.geometry.cad.size == pytest.approx(0.0051)
    assert read.geometry.cad.mould is not None and read.geometry.cad.mould.box == 0.03
    assert str(read.geometry.cad.file).endswith("my part.step")
    assert [b.law for b in read.bodies] == [
        "drucker-prager",
        "thermo-elasto-viscoplastic",
        "drucker-prager",
        "thermo-elastic",
    ]
    assert [i.name for i in read.interfaces] == ["casting/core-1", "casting/mould", "core-1/core-2"]
    assert read.interfaces[2].contact.method == "tied"
    assert [b.on for b in read.boundaries] == ["mould/outside"]
    assert text.count("CHOOSE") > 10
    assert "# 2 cm³" in text and "# 3 cm²" in text


def test_the_parts_of_a_tool_are_tied_to_each_other():
    bodies = ("casting", "die-low", "die-high", "chill", "core")
    pairs = [(a, b, 1e-4) for index, a in enumerate(bodies) for b in bodies[:index]]
    case = NewCase("a.step", 0.01, None, tuple((b, 1e-6) for b in bodies), tuple(pairs), ())
    read = load_case(tomllib.loads(case_text(case)))
    methods = {interface.name: interface.contact.method for interface in read.interfaces}
    assert {name for name, method in methods.items() if method == "tied"} == {
        "die-high/die-low", "chill/die-low", "chill/die-high", "die-low/core", "die-high/core",
        "chill/core",
    }  # fmt: skip
    assert sum(name.startswith("casting/") for name in methods) == 4
