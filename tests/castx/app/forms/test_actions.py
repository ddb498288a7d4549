"""Fields of forms are written into the case file, whose comments stay."""

import tomllib

import pytest

from castx.app.forms.actions import key_at, shown_forms, with_added, with_field
from castx.errors import CaseError

pytestmark = pytest.mark.serial

TEXT = """# by hand
[time]
end = 5  # seconds

[[bodies]]
name = "bar"
material = "Al-pure"
"""


def field(keys, value):
    return with_field({"text": TEXT, "keys": keys, "value": value})


def test_a_field_is_written_where_it_stands_and_its_comment_stays():
    text = field(["time", "end"], "8 min")
    assert 'end = "8 min"  # seconds' in text and text.startswith("# by hand")
    assert "largest_step = 2" in field(["time", "largest_step"], "2")
    assert tomllib.loads(field(["bodies", 0, "law"], "rigid"))["bodies"][0]["law"] == "rigid"


def test_texts_are_texts_whatever_they_look_like():
    assert tomllib.loads(field(["bodies", 0, "name"], "12"))["bodies"][0]["name"] == "12"
    assert tomllib.loads(field(["bodies", 0, "name"], '"12"'))["bodies"][0]["name"] == "12"
    assert tomllib.loads(field(["time", "end"], "12"))["time"]["end"] == 12


def test_an_emptied_field_is_taken_out():
    assert tomllib.loads(field(["time", "end"], " "))["time"] == {}


def test_a_table_that_is_missing_is_made():
    found = tomllib.loads(field(["output", "every"], "5 s"))
    assert found["output"] == {"every": "5 s"}


@pytest.mark.parametrize(
    "keys",
    [["nothing"], ["time", "ending"], ["bodies", 0], ["bodies", "name"], [0], [], ["time", True],
     ["bodies", -1, "name"], "time", ["materials", "mine", "density"], ["name", 0]],
)  # fmt: skip
def test_what_is_no_key_of_a_case_is_refused(keys):
    with pytest.raises(CaseError):
        field(keys, "1")


def test_an_entry_of_a_list_is_added():
    asked = {"text": TEXT, "list": "boundaries", "values": {"on": "bar/top", "pressure": "1 bar"}}
    found = tomllib.loads(with_added(asked))
    assert found["boundaries"] == [{"on": "bar/top", "pressure": "1 bar"}]
    for wrong in ({"values": {}}, {"list": "time"}, {"values": 3}):
        with pytest.raises(CaseError):
            with_added({**asked, **wrong})


def test_a_path_leads_through_lists_and_tables():
    assert key_at(("interfaces", 3, "heat", "law")).words[0] == "constant"
    assert key_at(("foundry", "modulus_mould", "material")).needed


def test_forms_of_a_text_that_is_no_toml_say_so():
    titles = [group["title"] for group in shown_forms({"text": TEXT})["groups"] if group["given"]]
    assert titles == ["Case", "bodies 1: bar", "time"]
    with pytest.raises(CaseError, match="no TOML"):
        shown_forms({"text": "[["})
