"""Conditions of surfaces in the text of a case: written, moved, told, and found to be lost."""

import tomllib

import pytest

from castx.app.text.on_surfaces import (
    lost_surfaces,
    said_of,
    surfaces_named,
    with_condition,
    with_feeder,
    with_surface_moved,
)

pytestmark = pytest.mark.serial

TEXT = """# by hand
[[boundaries]]
on = "part/top"         # open
heat = { type = "insulated" }
[foundry]
feeders = ["part/top"]
flat = ["part/low"]
[[stages]]
at = 3
boundaries = [{ on = "part/top", displacement = "free" }]
"""


def test_a_condition_takes_the_place_of_one_of_its_sort():
    text = with_condition(TEXT, "part/top", "displacement", {"normal": 0})
    text = with_condition(text, "part/top", "heat", {"type": "isothermal"})
    entry = {"on": "part/top", "heat": {"type": "isothermal"}, "displacement": {"normal": 0}}
    assert tomllib.loads(text)["boundaries"] == [entry]
    more = with_condition(text, "part/low", "heat", {"type": "insulated"})
    assert [e["on"] for e in tomllib.loads(more)["boundaries"]] == ["part/top", "part/low"]


def test_a_feeder_is_listed_once():
    assert with_feeder(TEXT, "part/top") == TEXT
    listed = tomllib.loads(with_feeder(TEXT, "part/low"))["foundry"]["feeders"]
    assert listed == ["part/top", "part/low"]
    assert tomllib.loads(with_feeder("", "part/low")) == {"foundry": {"feeders": ["part/low"]}}


def test_all_that_was_said_of_a_surface_moves_and_comments_stay():
    text = with_surface_moved(TEXT, "part/top", "part/lid")
    assert text.startswith("# by hand\n") and 'on = "part/lid"         # open' in text
    found = tomllib.loads(text)
    assert found["foundry"] == {"feeders": ["part/lid"], "flat": ["part/low"]}
    assert found["stages"][0]["boundaries"] == [{"on": "part/lid", "displacement": "free"}]


def test_what_is_said_of_a_surface_is_told_as_it_is_written():
    content = tomllib.loads(TEXT)
    assert said_of(content, "part/top") == 'heat = { type = "insulated" }; feeds'
    assert said_of(content, "part/low") == ""


def test_names_without_faces_are_told_with_those_that_there_are():
    content = tomllib.loads(TEXT)
    known = {"part/lid": [1], "part/low": [2], "mould/outside": [3]}
    told = lost_surfaces(content, known)
    assert set(told) == {"part/top"}
    assert "part has part/lid, part/low" in told["part/top"]
    assert "no body 'part'" in lost_surfaces(content, {"mould/outside": [3]})["part/low"]
    assert lost_surfaces(content, {"part/top": [1], "part/low": [2]}) == {}


@pytest.mark.parametrize("wrong", [{"boundaries": 3}, {"boundaries": [3, {}]}, {"foundry": []},
                                   {"foundry": {"feeders": "all", "flat": [3]}}])  # fmt: skip
def test_what_is_no_list_of_surfaces_names_none(wrong):
    assert list(surfaces_named(wrong)) == []
