"""What the page sends is of its kind, and never an option of a command."""

import pytest

from castx.app.text.arguments import number_of, text_of, word_of
from castx.errors import CaseError

pytestmark = pytest.mark.serial


def test_values_of_their_kind_are_taken():
    assert text_of({"a": "x"}, "a") == "x" and word_of({"a": "x y"}, "a") == "x y"
    assert word_of({}, "a") is None and word_of({"a": ""}, "a") is None
    assert number_of({}, "n") == 0 and number_of({"n": 7}, "n") == 7


@pytest.mark.parametrize("value", [None, 1, ["x"], {}])
def test_no_text_is_refused(value):
    with pytest.raises(CaseError):
        text_of({"a": value}, "a")


@pytest.mark.parametrize("value", ["--output=/etc/x", "-o", "a\nb", "\x1b[2J", "x" * 201, 5])
def test_no_word_for_a_command_is_refused(value):
    with pytest.raises(CaseError):
        word_of({"a": value}, "a")


@pytest.mark.parametrize("value", [-1, 1.5, True, "1"])
def test_no_number_is_refused(value):
    with pytest.raises(CaseError):
        number_of({"n": value}, "n")
