"""The registry of contact methods: what it refuses and derives, and where a name must stand."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

from castx.case.contact import InterfaceContact
from castx.contact.methods.description import UnknownKind
from castx.contact.methods.penalty import METHOD, PENALTY_KEY
from castx.contact.methods.registry import (
    DEFAULT,
    METHODS,
    described,
    keys,
    method_table,
    names,
    ordered,
    setting,
    users,
)
from castx.input.entries import Whole

pytestmark = pytest.mark.serial

PROJECT = Path(__file__).parents[4]
FOLDER = PROJECT / "castx/contact/methods"


def file_of(method=None, name="penalty") -> ModuleType:
    module = ModuleType(f"castx.contact.methods.{name}")
    if method is not None:
        vars(module)["METHOD"] = method
    return module


def test_every_file_is_a_method():
    files = {path.stem for path in FOLDER.glob("*.py")} - {"__init__", "description", "registry"}
    assert {name.replace("-", "_") for name in METHODS} == files
    assert DEFAULT in METHODS


@pytest.mark.parametrize(
    "change, text",
    [
        ({"summary": ""}, r"methods\.penalty: summary is missing"),
        ({"formula": " "}, "formula is missing"),
        ({"source": "", "advice": ""}, "source is missing; advice is missing"),
        ({"name": "spring"}, "name 'spring' is not that of the file"),
        ({"pair_law": None}, "pair_law is missing"),
        ({"unknowns": UnknownKind.GAPS}, "pair_law has no use"),
        ({"keys": (replace(PENALTY_KEY, summary=""),)}, "summary of the key 'penalty' is missing"),
    ],
)
def test_an_incomplete_description_is_refused(change, text):
    with pytest.raises(TypeError, match=text):
        described(file_of(replace(METHOD, **change)))


def test_a_file_without_a_description_is_refused():
    with pytest.raises(TypeError, match=r"methods\.penalty: METHOD is missing"):
        described(file_of())


def test_a_complete_description_is_accepted():
    assert described(file_of(replace(METHOD, name="half-soft"), "half_soft")).name == "half-soft"


def test_a_key_means_one_thing():
    other = replace(METHOD, name="other", keys=(replace(PENALTY_KEY, kind=Whole(1, 2)),))
    with pytest.raises(TypeError, match="key 'penalty' has two meanings"):
        ordered([METHOD, other])


def test_methods_are_ordered_by_their_unknowns_and_then_by_name():
    first, second = replace(METHOD, name="b"), replace(METHOD, name="a")
    hard = replace(METHOD, name="z", unknowns=UnknownKind.GAPS)
    assert list(ordered([first, second, hard])) == ["z", "a", "b"]
    assert list(ordered(METHODS.values())) == list(METHODS)


def test_a_setting_is_the_given_value_or_the_default():
    assert setting({"penalty": 1e12}, "penalty") == 1e12
    assert setting({}, "penalty") == PENALTY_KEY.default


def test_defaults_are_values_of_their_kind():
    assert {name: key.kind.read(key.default) for name, key in keys().items()} == {
        name: key.default for name, key in keys().items()
    }


@pytest.mark.parametrize("method", names())
def test_a_case_takes_every_method_with_its_keys(method):
    own = {key.name: key.default for key in METHODS[method].keys}
    assert InterfaceContact.read({"method": method, **own}).settings == {
        name: key.default for name, key in keys().items()
    }


@pytest.mark.parametrize("key", keys())
def test_users_are_the_methods_with_a_key(key):
    assert users(key)
    assert set(users(key)) == {row.name for row in method_table() if key in row.keys}


def test_the_table_has_a_row_for_each_method():
    assert [row.name for row in method_table()] == list(METHODS)
    assert all(row.summary.endswith(".") for row in method_table())


@pytest.mark.parametrize("method", names(lambda method: method.fallback))
def test_every_method_stands_in_a_notebook_and_in_the_random_castings(method):
    notebooks = [path.read_text() for path in (PROJECT / "demos").glob("*_notebook.py")]
    shown = any(f'"{method}"' in text or "castx.contact_methods()" in text for text in notebooks)
    assert shown, f"no notebook shows {method!r}"
    robustness = (PROJECT / "bench/robustness.py").read_text()
    assert "names(lambda method: method.fallback)" in robustness, "bench/robustness.py: METHODS"


@pytest.mark.parametrize("name", METHODS)
def test_a_method_names_the_class_that_computes_it(name):
    module, _, found = METHODS[name].computed_by.rpartition(".")
    assert module.startswith(("castx.contact.", "castx.equilibrium."))
    assert isinstance(getattr(import_module(module), found), type)
