"""Characters that a terminal obeys are written out; letters of all languages stay."""

import pytest

from castx.input.printable import printable

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("plain", "plain"),
        ("gießerei, 鋳造, ελ", "gießerei, 鋳造, ελ"),
        ("\x1b[2Jgone", "\\x1b[2Jgone"),
        ("\x9b2J", "\\x9b2J"),
        ("name\u202e\u2066", "name\\u202e\\u2066"),
        ("a\u2028b\x7f", "a\\u2028b\\x7f"),
        ("two\nlines", "two\\nlines"),
        ("half \udcff", "half \\udcff"),
    ],
)
def test_only_what_a_terminal_obeys_is_written_out(text, shown):
    assert printable(text) == shown


def test_ends_of_lines_may_stay():
    assert printable("a\nb\r\x1b", keep="\n") == "a\nb\\r\\x1b"
