"""Text of foreign origin made safe to show: a terminal obeys control and direction characters."""

from __future__ import annotations

from unicodedata import category

_OBEYED = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})
"""Categories of Unicode: control, format (such as a change of direction), half of a character, and
ends of lines and paragraphs."""


def printable(text: str, keep: str = "") -> str:
    r"""Return a text in which characters that a terminal obeys are written out, such as \x1b.

    Args:
        text: from a file or a command line.
        keep: characters that stay, such as ends of lines.
    """
    if text.isascii() and text.isprintable():
        return text
    return "".join(
        letter if letter in keep or category(letter) not in _OBEYED else _written_out(letter)
        for letter in text
    )


def _written_out(letter: str) -> str:
    return letter.encode("unicode_escape").decode("ascii")
