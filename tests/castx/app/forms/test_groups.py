"""Groups of fields show what a text gives, by tables, and only keys that may stand there."""

import pytest

from castx.app.forms.groups import groups_of, lists_of, shown, suggestions, title_of

pytestmark = pytest.mark.serial

CONTENT = {
    "name": "a case",
    "geometry": {"model": "3d", "file": "bar.step", "size": "10 mm"},
    "bodies": [{"name": "bar", "material": "Al-pure"}, {"name": "die", "material": "mine"}],
    "interfaces": [{"bodies": ["bar", "die"], "heat": {"law": "constant", "closed": 2000}}],
    "materials": {"mine": {"extends": "steel-H13"}},
    "time": {"end": 5},
}


def groups():
    return {group["title"]: group for group in groups_of(CONTENT)}


def fields(title):
    return {field["name"]: field for field in groups()[title]["fields"]}


def test_each_table_is_a_group_with_its_values():
    found = groups()
    assert fields("Case")["name"]["value"] == "a case" and "materials" not in fields("Case")
    assert found["bodies 2: die"]["path"] == ["bodies", 1]
    assert fields("bodies 2: die")["material"]["value"] == "mine"
    assert fields("bodies 2: die")["material"]["key"] == "bodies[1].material"
    assert fields("time")["end"]["value"] == "5" and fields("time")["end"]["given"]
    assert fields("interfaces 1: bar/die, heat")["closed"]["value"] == "2000"
    assert (
        found["interfaces 1: bar/die, heat"]["given"]
        and not found["interfaces 1: bar/die, contact"]["given"]
    )


def test_keys_of_a_geometry_are_those_of_its_sort():
    assert "across" in fields("geometry") and "radius" not in fields("geometry")
    cylinder = {"geometry": {"generator": "cylinder_in_mould"}}
    made = next(group for group in groups_of(cylinder) if group["title"] == "geometry")
    names = [field["name"] for field in made["fields"]]
    assert "radius" in names and "across" not in names and "lid" not in names
    read = next(g for g in groups_of({"geometry": {"file": "a.msh"}}) if g["title"] == "geometry")
    assert sorted(field["name"] for field in read["fields"]) == ["file", "model"]


def test_texts_are_shown_without_quotes_unless_they_would_be_read_as_something_else():
    assert shown("10 mm", False) == "10 mm" and shown(5, False) == "5"
    assert shown("5", False) == '"5"' and shown("5", True) == "5"
    assert shown([["0 s", 1]], False) == '[["0 s", 1]]'


def test_lists_can_get_an_entry():
    lists = {one["name"]: one for one in lists_of()}
    assert {"bodies", "interfaces", "boundaries", "probes", "stages"} <= set(lists)
    names = [field["name"] for field in lists["probes"]["fields"] if field["needed"]]
    assert names == ["name", "at", "quantities"]


def test_names_are_suggested():
    found = suggestions(CONTENT)
    assert found["material"][0] == "mine" and "AlSi7Mg" in found["material"]
    assert found["body"] == ["bar", "die"] and found["from"]
    assert suggestions({})["body"] == []


def test_a_table_is_called_by_what_it_is_about():
    assert title_of(("boundaries", 0), {"on": "bar/top"}) == "boundaries 1: bar/top"
    assert title_of(("interfaces", 1), {"bodies": ["a", "b"]}) == "interfaces 2: a/b"
    assert title_of(("interfaces", 1, "heat"), {"law": "x"}) == "interfaces 2 heat"
