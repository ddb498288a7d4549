"""Files of numbers with sources: names, content, numbers and mistakes of form."""

from __future__ import annotations

import pytest

from castx.errors import CaseError
from castx.input.problems import Problem
from castx.input.sourced import (
    entry_names,
    file_content,
    item_problems,
    items,
    plain,
    text_problems,
)

pytestmark = pytest.mark.serial

KEYS = ("value", "unit", "source")
DENSITY = {"value": 7, "unit": "kg/m³", "source": "somebody (1999)"}
PHASES = {"solid": {"value": 1, "source": "x"}, "liquid": {"value": 2, "source": "x"}}
CONTENT = {"summary": "a", "density": DENSITY, "heat": PHASES, "law": "none"}


def test_the_files_of_a_folder_are_its_entries(tmp_path):
    for name in ("b.toml", "a.toml", "entries.py"):
        (tmp_path / name).write_text("value = 1\n")
    assert entry_names(tmp_path) == ("a", "b")
    assert file_content(tmp_path / "a.toml") == {"value": 1}


def test_what_is_no_toml_is_refused_with_file_and_place(tmp_path):
    (tmp_path / "a.toml").write_text("value = \n")
    with pytest.raises(CaseError, match=r"a.toml: .*line 1"):
        file_content(tmp_path / "a.toml")


def test_numbers_and_what_belongs_together():
    assert list(items(CONTENT, ("summary",))) == [
        (("density",), DENSITY),
        (("heat", "solid"), PHASES["solid"]),
        (("heat", "liquid"), PHASES["liquid"]),
        (("law",), "none"),
    ]
    assert plain(DENSITY) == 7 and plain(PHASES) == {"solid": 1, "liquid": 2}


def test_texts_that_are_missing():
    found = list(text_problems({"a": "x", "b": "", "c": 3}, ("a", "b", "c", "d")))
    assert [problem.path for problem in found] == [("b",), ("c",), ("d",)]


@pytest.mark.parametrize(
    ("item", "unit", "path", "text"),
    [
        (7, "kg/m³", ("x",), "{ value = ..., unit = ..., source = ... }"),
        ({**DENSITY, "valid": 1}, "kg/m³", ("x", "valid"), "unknown key; known keys: value, unit"),
        ({"unit": "kg/m³", "source": "x"}, "kg/m³", ("x", "value"), "missing"),
        ({"value": 1, "unit": "kg/m³"}, "kg/m³", ("x", "source"), "author, year"),
        (DENSITY, "m", ("x", "unit"), 'must be "m"; convert'),
        (DENSITY, "", ("x", "unit"), "a pure number has none"),
    ],
)
def test_mistakes_of_form(item, unit, path, text):
    (problem,) = item_problems(("x",), item, KEYS, unit)
    assert isinstance(problem, Problem) and problem.path == path and text in problem.text


def test_numbers_without_mistakes():
    assert not list(item_problems(("x",), DENSITY, KEYS, "kg/m³"))
    assert not list(item_problems(("x",), DENSITY, KEYS, None))
    assert not list(item_problems(("x",), {"value": 1, "source": "x"}, KEYS, ""))
