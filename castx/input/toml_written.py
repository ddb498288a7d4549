"""Content of a case written as TOML."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def toml_value(value: Any) -> str:
    """Return a value as TOML writes it in one line.

    Args:
        value: of the types of JSON: numbers, texts, lists, tables.
    """
    if isinstance(value, Mapping):
        parts = (f"{toml_key(key)} = {toml_value(item)}" for key, item in value.items())
        inside = ", ".join(parts)
        return f"{{ {inside} }}" if inside else "{}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(toml_value(item) for item in value)}]"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value)


def toml_text(content: Mapping[str, Any]) -> str:
    """Return the content of a case file: a heading for each table and for each one of a list.

    Args:
        content: keys and values; None stands for a key that is not there.
    """
    plain, tables = [], []
    for key, value in content.items():
        if isinstance(value, Mapping):
            tables.append(_table(f"[{toml_key(key)}]", value))
        elif isinstance(value, list | tuple) and value and all(
            isinstance(item, Mapping) for item in value
        ):  # fmt: skip
            tables += [_table(f"[[{toml_key(key)}]]", item) for item in value]
        elif value is not None:
            plain.append(f"{toml_key(key)} = {toml_value(value)}")
    return "\n\n".join(["\n".join(plain), *tables] if plain else tables) + "\n"


def _table(heading: str, content: Mapping[str, Any]) -> str:
    given = ((key, value) for key, value in content.items() if value is not None)
    lines = [f"{toml_key(key)} = {toml_value(value)}" for key, value in given]
    return "\n".join([heading, *lines])


def toml_key(key: str) -> str:
    """Return a key as TOML writes it."""
    return key if _BARE.fullmatch(key) else toml_value(key)
