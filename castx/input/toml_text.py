"""TOML read with limits: the reader's time grows with the square of a key's levels."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from typing import Any

from castx.errors import CaseError

DEEPEST = 20
"""Levels of nesting that a case file may have."""
MOST_KEYS = 20_000
"""Keys that it may have."""
_MOST_DOTS = 200
"""Dots in a line that do not stand in a number; keys have at most `DEEPEST`, texts have others."""

_IN_NUMBER = re.compile(r"\d\.\d")
TOO_DEEP = f"lists or tables are nested more than {DEEPEST} levels deep"


def parse_toml(text: str) -> dict[str, Any]:
    """Return the content of a TOML text.

    Raises:
        CaseError: it has too many keys or levels.
        ValueError: it is no TOML.
    """
    if text.count("=") > MOST_KEYS:
        raise CaseError(f"more than {MOST_KEYS} keys; leave out what is not needed")
    for number, line in enumerate(text.splitlines(), start=1):
        if line.count(".") > _MOST_DOTS and _dots_of_keys(line) > _MOST_DOTS:
            raise CaseError(f"{TOO_DEEP}: line {number} has more than {_MOST_DOTS} dots")
    try:
        content = tomllib.loads(text)
    except RecursionError:
        raise CaseError(TOO_DEEP) from None
    refuse_too_deep(content)
    return content


def _dots_of_keys(line: str) -> int:
    return line.count(".") - len(_IN_NUMBER.findall(line))


def refuse_too_deep(content: Any) -> None:
    """Refuse tables and lists that are nested too deep, found without recursion.

    Raises:
        CaseError: more than `DEEPEST` levels.
    """
    layer = [content]
    for _ in range(DEEPEST):
        inside = [value for item in layer for value in _items(item)]
        layer = [value for value in inside if isinstance(value, dict | list)]
    if layer:
        raise CaseError(TOO_DEEP)


def _items(container: Any) -> Iterable[Any]:
    return container.values() if isinstance(container, dict) else container
