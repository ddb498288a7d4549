"""TOML is read as Python reads it, and refused where reading would take too long."""

import tomllib

import pytest

from castx.errors import CaseError
from castx.input.toml_text import DEEPEST, MOST_KEYS, parse_toml

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[a]\nb = 'x'\n[[c]]\nd = { e = [1, [2.5]] }",
        "table = [" + ", ".join(f"[{k}.5, {k}.25]" for k in range(1000)) + "]",
        ".".join("a" * DEEPEST) + " = 1",
    ],
)
def test_content_is_that_of_the_library(text):
    assert parse_toml(text) == tomllib.loads(text)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (".".join("a" * 100_000) + " = 1", "line 1 has more than 200 dots"),
        ("x = 1\n[" + ".".join("1" * 100_000) + "]", "line 2 has more than 200 dots"),
        (".".join("a" * (DEEPEST + 1)) + " = 1", "nested more than 20 levels"),
        ("x = " + "[" * 100_000, "nested more than 20 levels"),
        ("x = " + "{a=" * 100_000, "more than 20000 keys"),
        ("x = " + "{a=" * 10_000, "nested more than 20 levels"),
        ("x = 1\n" * (MOST_KEYS + 1), "more than 20000 keys"),
    ],
)
def test_what_would_take_too_long_is_refused(text, reason):
    with pytest.raises(CaseError, match=reason):
        parse_toml(text)


def test_what_is_no_toml_is_an_error_of_the_library():
    with pytest.raises(tomllib.TOMLDecodeError):
        parse_toml("x = ")
