"""Docstrings of castx as reStructuredText.

They are plain text: single backticks name code, formulas are written as they are read, and an
indented block after a colon is a formula or an example. Characters that reStructuredText takes for
markup are therefore escaped outside of backticks.
"""

from __future__ import annotations

import re

_CODE = re.compile(r"(`[^`]+`)")
_MARKUP = re.compile(r"([*|\\])|_(?!\w)")
_SECTION = re.compile(r"^(Args|Attributes|Returns|Raises|Yields|Example|Examples):$")


def restructured(text: str) -> str:
    """Return a docstring as reStructuredText."""
    return "\n".join(restructured_lines(text.splitlines()))


def restructured_lines(lines: list[str]) -> list[str]:
    """Return the lines of a docstring as lines of reStructuredText."""
    result: list[str] = []
    literal = False
    section = example = False
    for number, line in enumerate(lines):
        indented = line.startswith("    ")
        example = line.startswith(">>>") or (example and bool(line))
        if _SECTION.match(line):
            section = True
        elif line and not indented:
            section = False
        if line and not indented:
            literal = False
        if indented and not section and not literal and not example:
            literal = True
            result += ["", "::", ""]
        elif line and not indented and number and lines[number - 1].startswith("    "):
            result.append("")
        result.append(line if literal or example else _escaped(line))
    return result


def _escaped(line: str) -> str:
    parts = _CODE.split(line)
    return "".join(
        f"`{part}`" if part.startswith("`") else _MARKUP.sub(r"\\\g<0>", part) for part in parts
    )
