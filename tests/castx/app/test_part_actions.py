"""Names and conditions of faces stand in the case file; castx new gets what was chosen."""

import json
import tomllib

import pytest

from castx.app import faces
from castx.app.part_actions import FEEDER, HELD, PartActions, choices, new_arguments
from castx.app.workplace import Workplace
from castx.errors import CaseError
from castx.meshes.cad.seen import SeenPart
from tests.castx.app.test_faces import CASE, FLAT
from tests.castx.app.test_selectors import FACES, flat

pytestmark = pytest.mark.serial

SHARED = flat(22, [0, 1, 0], [0, 0.1, 0], [1, 0.1, 1], bodies=("part", "mould"))


@pytest.fixture
def actions(tmp_path, monkeypatch):
    (tmp_path / "part.step").write_text("")
    found = [*FACES, SHARED]
    triangles = tuple(face.points.reshape(1, 3, 3) for face in (*FLAT, SHARED))
    monkeypatch.setattr(
        faces, "seen_apart", lambda *_: SeenPart(tuple(found), triangles, {"symmetry-x": (4,)})
    )
    return PartActions(Workplace(tmp_path))


def named(actions, text=CASE, **asked):
    return actions.named({"path": "case.toml", "text": text, **asked})


def test_a_click_proposes_a_selector_and_tells_a_name_that_there_is(actions):
    asked = {"path": "case.toml", "text": CASE}
    found = actions.proposed({**asked, "face": 3})
    assert found["selector"] == '{ body = "part", normal = "-z" }' and found["name"] is None
    assert found["faces"] == [3] and found["free"] and found["body"] == "part"
    known = actions.proposed({**asked, "face": 1})
    assert known["name"] == "up" and known["selector"] == '{ normal = "+z" }'
    assert known["faces"] == [0, 1, 2] and "within" in known["proposal"]
    assert not actions.proposed({**asked, "face": 6})["free"]
    with pytest.raises(CaseError):
        actions.proposed({**asked, "face": 7})
    assert actions.selected({**asked, "selector": "{ radius = 0.01 }"}) == {"faces": [5]}
    with pytest.raises(CaseError):
        actions.selected({**asked, "selector": "3"})


def test_a_name_and_a_condition_are_written(actions):
    bore = {"name": "bore", "selector": "{ radius = 0.01 }"}
    numbers = {"coefficient": "500", "ambient": "20 degC"}
    text = named(actions, **bore, kind="convection", numbers=numbers)
    found = tomllib.loads(text)
    assert found["geometry"]["surfaces"]["bore"] == {"radius": 0.01}
    assert found["geometry"]["surfaces"]["up"] == {"normal": "+z"}
    heat = {"type": "convection", "coefficient": 500, "ambient": "20 degC"}
    assert found["boundaries"] == [{"on": "part/bore", "heat": heat}]
    text = named(actions, text, **bore, kind=HELD)
    again = named(actions, text, **bore, kind="insulated")
    (entry,) = tomllib.loads(again)["boundaries"]
    assert entry == {
        "on": "part/bore", "heat": {"type": "insulated"}, "displacement": {"normal": 0}
    }  # fmt: skip


HEATED = (
    CASE
    + """
[[boundaries]]
on = "part/outside"
heat = { type = "insulated" }
"""
)


def test_a_click_tells_the_conditions_that_a_face_has(actions):
    found = actions.proposed({"path": "case.toml", "text": HEATED, "face": 3})
    assert found["on"] == "part/outside" and found["said"] == 'heat = { type = "insulated" }'
    assert actions.proposed({"path": "case.toml", "text": HEATED, "face": 1})["said"] == ""


def test_the_last_face_without_a_name_takes_the_conditions_of_outside_to_its_name(actions):
    text = named(actions, HEATED, name="low", selector='{ normal = "-z" }')
    assert tomllib.loads(text)["boundaries"][0]["on"] == "part/outside"  # the bore is left
    text = named(actions, text, name="bore", selector="{ radius = 0.01 }", kind=HELD)
    insulated = {"on": "part/bore", "heat": {"type": "insulated"}, "displacement": {"normal": 0}}
    assert tomllib.loads(text)["boundaries"] == [insulated]


def test_another_name_for_the_same_faces_takes_the_place_of_the_first_one(actions):
    bore = {"selector": "{ radius = 0.01 }"}
    text = named(actions, name="bore", kind="insulated", **bore)
    text = named(actions, text, name="hole", **bore)
    found = tomllib.loads(text)
    assert set(found["geometry"]["surfaces"]) == {"up", "none", "hole"}
    assert found["boundaries"] == [{"on": "part/hole", "heat": {"type": "insulated"}}]
    # a name that exists already keeps its own conditions
    text = named(actions, text, name="up", selector='{ normal = "+z" }', kind="insulated")
    assert [entry["on"] for entry in tomllib.loads(text)["boundaries"]] == ["part/hole", "part/up"]


def test_a_face_that_feeds_is_listed_once_beside_the_others(actions):
    up = {"name": "up", "selector": '{ normal = "+z" }', "kind": FEEDER}
    text = named(actions, **up)
    assert tomllib.loads(text)["foundry"] == {"feeders": ["part/up"]}
    assert named(actions, text, **up) == text
    both = named(actions, text, name="bore", selector="{ radius = 0.01 }", kind=FEEDER)
    assert tomllib.loads(both)["foundry"]["feeders"] == ["part/up", "part/bore"]


def test_faces_between_bodies_have_names_only(actions):
    shared = {"name": "side", "selector": '{ touches = "mould" }'}
    assert "boundaries" not in tomllib.loads(named(actions, **shared))
    with pytest.raises(CaseError, match="interface"):
        named(actions, **shared, kind=HELD)
    for wrong in ({"name": "a/b"}, {"selector": "{ radius = 5 }"}, {"kind": "magic"}):
        with pytest.raises(CaseError):
            named(actions, **{"name": "x", "selector": '{ normal = "-z" }', **wrong})


def test_choices_are_those_of_the_databases():
    found = choices()
    refused = {p["name"]: set(p["refuses"]) for p in found["processes"]}
    assert refused["sand"] == set() and refused["high-pressure-die"] == {"top"}
    json.dumps(found)
    melts = {m["name"]: m["melts"] for m in found["materials"]}
    assert melts["AlSi7Mg"] and not melts["steel-H13"]
    convection = next(c for c in found["conditions"] if c["name"] == "convection")
    assert [key["name"] for key in convection["keys"]] == ["coefficient", "ambient"]
    assert [key["text"] for key in convection["keys"]] == ["coefficient [W/m²/K]", "ambient [°C]"]
    assert [key["usual"] for key in convection["keys"]] == ["5 to 5000", "10 to 40"]


def test_castx_new_gets_what_was_chosen(actions, tmp_path):
    place = Workplace(tmp_path)
    asked = {"path": "part.step", "process": "sand", "alloy": "", "split": "z", "output": "c.toml"}
    assert new_arguments(place, asked) == [
        "new", "part.step", "--output", "c.toml", "--process", "sand", "--split", "z"
    ]  # fmt: skip
    (tmp_path / "c.toml").write_text("")
    for wrong in ({}, {"path": "../part.step"}, {"output": "../d.toml"}, {"split": "--help"}):
        with pytest.raises(CaseError):
            new_arguments(place, {**asked, **wrong})
