"""Changes of a case file keep its comments and everything else."""

import tomllib

import pytest

from castx.app.text.editing import value_of, with_entry, with_value
from castx.errors import CaseError

pytestmark = pytest.mark.serial

TEXT = """# a case
name = "x"
[geometry]
size = "1 mm"   # the largest, "of all"
corners = [
  [1, 2],  # first
]
# of nothing

# bodies follow
[[bodies]]
name = "a"
start = { t = 20, u = 1 }
[[bodies]]
name = "b"

[time]
end = 3
"""


def changed(path, value, text=TEXT):
    """Return the lines that a change takes away and adds."""
    new = with_value(text, path, value)
    before, after = text.splitlines(), new.splitlines()
    gone = [line for line in before if line not in after]
    return gone, [line for line in after if line not in before], tomllib.loads(new)


@pytest.mark.parametrize(
    ("path", "value", "gone", "new"),
    [
        (("geometry", "size"), "2 mm", ['size = "1 mm"   # the largest, "of all"'],
         ['size = "2 mm"   # the largest, "of all"']),
        (("geometry", "corners"), [], ["corners = [", "  [1, 2],  # first", "]"], ["corners = []"]),
        (("geometry", "across"), 2, [], ["across = 2"]),
        (("title",), True, [], ["title = true"]),
        (("bodies", 0, "start", "t"), 30, ["start = { t = 20, u = 1 }"],
         ["start = { t = 30, u = 1 }"]),
        (("bodies", 0, "start", "t"), None, ["start = { t = 20, u = 1 }"], ["start = { u = 1 }"]),
        (("bodies", 1, "law"), "rigid", [], ['law = "rigid"']),
        (("time", "end"), None, ["end = 3"], []),
        (("geometry", "surfaces", "top face"), {"normal": "+z"}, [],
         ["[geometry.surfaces]", '"top face" = { normal = "+z" }']),
        (("output", "every"), 1.5, [], ["[output]", "every = 1.5"]),
        (("bodies", 1, "start", "t"), 7, [], ["[bodies.start]", "t = 7"]),
    ],
)  # fmt: skip
def test_one_value_changes_and_nothing_else(path, value, gone, new):
    found = changed(path, value)
    assert found[:2] == (gone, new)
    expected = tomllib.loads(TEXT)
    inner = expected
    for key in path[:-1]:
        inner = inner.setdefault(key, {}) if isinstance(inner, dict) else inner[key]
    if value is None:
        del inner[path[-1]]
    else:
        inner[path[-1]] = value
    assert found[2] == expected


def test_an_entry_stands_behind_those_of_its_list():
    new = with_entry(TEXT, "bodies", {"name": "c", "start": {"t": 1}})
    assert [body["name"] for body in tomllib.loads(new)["bodies"]] == ["a", "b", "c"]
    assert new.index('name = "c"') < new.index("[time]")
    assert tomllib.loads(with_entry(TEXT, "probes", {"at": [0]}))["probes"] == [{"at": [0]}]


def test_what_cannot_be_changed_is_refused():
    with pytest.raises(CaseError, match="no TOML"):
        with_value("a = = 1", ("b",), 1)
    with pytest.raises(CaseError, match="nothing leads there"):
        with_value(TEXT, ("bodies", 5, "name"), "d")
    with pytest.raises(CaseError, match="does not change"):
        with_entry("bodies = [{ name = 'a' }]\n", "bodies", {"name": "b"})
    with pytest.raises(CaseError, match="no list"):
        with_entry(TEXT, "time", {"end": 1})


def test_values_are_read_as_toml_or_as_text():
    assert [value_of(text) for text in ("20", '"a"', "20 degC", "[[0, 1]]")] == [
        20, "a", "20 degC", [[0, 1]]
    ]  # fmt: skip


def test_a_comment_follows_the_entry_that_it_names():
    line = 'heat = { from = "iron-sand" }     # castx interfaces iron-sand; not iron-sand-coated'
    text = f"[[interfaces]]\n{line}\n"
    found = with_value(text, ("interfaces", 0, "heat", "from"), "bronze-sand")
    assert found.splitlines()[1] == (
        'heat = { from = "bronze-sand" }     # castx interfaces bronze-sand; not iron-sand-coated'
    )
    kept = with_value("law = 3 # law of 3\n", ("law",), 4)
    assert kept == "law = 4 # law of 3\n", "numbers in a comment may be of something else"
