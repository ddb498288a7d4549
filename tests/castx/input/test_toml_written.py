"""TOML that is written is read back the same."""

import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from castx.input.toml_written import toml_text, toml_value

pytestmark = pytest.mark.serial

TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
PLAIN = st.booleans() | st.integers(-(2**62), 2**62) | TEXTS | st.floats(allow_nan=False)
VALUES = st.recursive(
    PLAIN, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(TEXTS, inner, max_size=3)
)


@given(VALUES)
def test_a_value_is_read_back(value):
    assert tomllib.loads(f"value = {toml_value(value)}")["value"] == value


@given(st.dictionaries(TEXTS, VALUES, max_size=4))
def test_a_case_is_read_back(content):
    assert tomllib.loads(toml_text(content)) == content


def test_tables_have_headings():
    text = toml_text({"name": "a", "time": {"end": 1.0}, "bodies": [{"name": "b"}, {"name": "c"}]})
    assert text == (
        'name = "a"\n\n[time]\nend = 1.0\n\n[[bodies]]\nname = "b"\n\n[[bodies]]\nname = "c"\n'
    )


def test_none_is_left_out():
    assert toml_text({"a": None, "b": {"c": None, "d": 1}}) == "[b]\nd = 1\n"
