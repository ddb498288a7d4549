"""Keys of forms come from the schema: units, words, defaults, tables inside."""

import pytest

from castx.app.forms.keys import form_key, keys_of

pytestmark = pytest.mark.serial


def test_keys_that_a_table_must_have_come_first():
    keys = keys_of("Body")
    assert [key.name for key in keys if key.needed] == ["name", "material"]
    assert [key.name for key in keys[:2]] == ["name", "material"]
    law = next(key for key in keys if key.name == "law")
    assert law.words[0] == "thermo-elastic" and law.default == '"thermo-elastic"' and law.text


def test_a_number_has_its_unit_and_its_range_also_where_it_may_be_left_out():
    end, first = (next(k for k in keys_of("Time") if k.name == n) for n in ("end", "first_step"))
    assert end.meaning.endswith("(a time [s], positive)") and not end.text
    assert first.meaning.endswith("a time [s], positive") and first.default == ""


@pytest.mark.parametrize(
    "default, shown", [(2e6, "2000000"), (0.4, "0.4"), (0.0, "0"), (7, "7"), (1e-9, "1e-09")]
)
def test_a_default_is_shown_as_people_write_it(default, shown):
    assert form_key("most", {"type": "number", "default": default}, False).default == shown


def test_tables_inside_and_lists_of_tables_are_known():
    keys = {key.name: key for key in keys_of(None)}
    assert keys["time"].table == "Time" and keys["bodies"].entries == "Body"
    heat = next(key for key in keys_of("Interface") if key.name == "heat")
    assert heat.table == "InterfaceHeat"


def test_a_switch_has_two_words():
    key = form_key("lid", {"type": "boolean", "default": False}, False)
    assert key.words == ("true", "false") and key.default == "false" and not key.text
