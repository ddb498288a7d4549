"""Files of numbers with their sources: one TOML file for each entry of a database.

Such a file has a few lines of text about the entry, and for each number a table { value, unit,
source, ... }, one level deeper for what belongs together. Where no source is known, it says so.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Sequence
from importlib.resources.abc import Traversable
from typing import Any

from castx.errors import CaseError
from castx.input.problems import KeyPath, Problem, among

UNKNOWN_SOURCE = "representative value, source not established"
"""Source of numbers whose origin is unknown."""


def entry_names(folder: Traversable) -> tuple[str, ...]:
    """Return the names of all entries of a folder in alphabetical order."""
    names = (file.name for file in folder.iterdir())
    return tuple(sorted(name.removesuffix(".toml") for name in names if name.endswith(".toml")))


def file_content(file: Traversable) -> dict[str, Any]:
    """Return the content of the file of an entry.

    Raises:
        CaseError: it is no TOML; with its name and the place.
    """
    try:
        return tomllib.loads(file.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise CaseError(f"{file}: {error}") from None


def items(content: dict[str, Any], about: Sequence[str]) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield the numbers of a file with the keys that lead to them.

    Args:
        content: of the file.
        about: its keys that are texts about the entry.
    """
    for key, item in content.items():
        if key not in about and _is_item(item):
            yield (key,), item
        elif key not in about:
            yield from (((key, inner), part) for inner, part in item.items())


def plain(item: Any) -> Any:
    """Return a number, or several that belong together, as a case file gives it."""
    return item["value"] if _is_item(item) else {key: part["value"] for key, part in item.items()}


def _is_item(value: Any) -> bool:
    """Whether a table is a number rather than a table of numbers."""
    return not isinstance(value, dict) or not all(isinstance(v, dict) for v in value.values())


def text_problems(content: dict[str, Any], about: Sequence[str]) -> Iterator[Problem]:
    """Yield the texts about an entry that are missing."""
    for key in about:
        if not isinstance(content.get(key), str) or not content[key]:
            yield Problem((key,), "missing; a text in quotes is needed")


def item_problems(
    path: KeyPath, item: Any, keys: Sequence[str], unit: str | None
) -> Iterator[Problem]:
    """Yield mistakes in the form of a number, whatever its value is.

    Args:
        path: keys that lead to it.
        item: what stands there.
        keys: those that it may have.
        unit: its SI unit, "" for a pure number; None: not known.
    """
    if not isinstance(item, dict):
        given = ", ".join(f"{key} = ..." for key in keys)
        yield Problem(path, f"a table is needed: {{ {given} }}")
        return
    for key in set(item) - set(keys):
        yield Problem((*path, key), f"unknown key; {among(key, keys, what='known keys')}")
    if "value" not in item:
        yield Problem((*path, "value"), "missing; this key is needed")
    if not isinstance(item.get("source"), str) or not item["source"]:
        text = f"missing; author, year and table or equation, or {UNKNOWN_SOURCE!r}"
        yield Problem((*path, "source"), text)
    if unit is not None and item.get("unit", "") != unit:
        cure = f'must be "{unit}"; convert the numbers'
        yield Problem((*path, "unit"), cure if unit else "a pure number has none")
