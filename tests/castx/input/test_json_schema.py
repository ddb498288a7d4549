"""The JSON schema of a case accepts all demos, and refuses what the reading of a case refuses."""

import copy
import json
import tomllib
import warnings
from pathlib import Path

import jsonschema
import pytest

from castx.case.case import Case
from castx.input.json_schema import meanings

pytestmark = pytest.mark.serial

DEMOS = sorted([*Path("demos").rglob("*.toml"), *Path("validation").glob("*/case.toml")])


@pytest.fixture(scope="module")
def schema():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = Case.model_json_schema()
    jsonschema.Draft202012Validator.check_schema(found)
    return json.loads(json.dumps(found))


@pytest.mark.parametrize("path", DEMOS, ids=str)
def test_demos_are_valid(schema, path):
    case = tomllib.loads(path.read_text())
    errors = jsonschema.Draft202012Validator(schema).iter_errors(case)
    assert not [error.message for error in errors]


@pytest.mark.parametrize(
    "table, key, value, text",
    [
        (("time",), "largest_stepp", 1.0, "largest_stepp"),
        (("geometry",), "radios", 1.0, "radios"),
        (("geometry",), "generator", "cylindre", "cylindre"),
        (("bodies", 0), "law", "elastic", "thermo-elastic"),
        (("coupling",), "passes", 0, "minimum"),
        (("time",), "end", [], "number"),
    ],
)
def test_mistakes_are_found(schema, table, key, value, text):
    case = copy.deepcopy(tomllib.loads(Path("demos/cylinder.toml").read_text()))
    part = case
    for step in table:
        part = part[step]
    part[key] = value
    (error,) = jsonschema.Draft202012Validator(schema).iter_errors(case)
    assert text in error.message


def test_units_and_allowed_words_are_told(schema):
    time = schema["$defs"]["Time"]["properties"]
    assert time["end"]["type"] == ["number", "string"]
    assert time["end"]["description"].endswith("of the first one (a time [s], positive)")
    assert time["largest_step"]["description"].startswith("by default a twentieth of the end")
    scheme = schema["$defs"]["Coupling"]["properties"]["scheme"]
    assert "iterated" in scheme["enum"]
    geometry = schema["$defs"]["Geometry"]["properties"]
    assert geometry["radius"]["description"] == "of the casting"
    assert geometry["across"]["maximum"] == 20
    assert geometry["across"]["description"].startswith("cells across a wall")
    assert geometry["size"]["description"].startswith("largest element size (a length [m], positi")


def test_what_is_left_out_is_said_in_words_of_the_file():
    class Described:
        """One.

        Attributes:
            depth: of a
                place [m]; None: everywhere.
            other: of it.
        """

    assert meanings(Described) == {
        "depth": "of a place [m]; left out: everywhere", "other": "of it"
    }  # fmt: skip
