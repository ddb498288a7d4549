"""The materials that come with castx: `database/NAME.toml`.

Every property there is a table { value, unit, source, valid }, one level deeper for a phase, for
`hardening` and for `liquid`: the value as in a case file, its SI unit (left out of pure numbers),
author, year and table or equation, and the lowest and highest temperature [°C] for which it is
valid (left out where it does not depend on temperature). Where no source is known, it says so.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from castx.errors import CaseError
from castx.input.problems import KeyPath, Problem, Refusal, among, summary
from castx.input.units import ABSOLUTE_ZERO
from castx.materials.description import MaterialDescription
from castx.materials.sources import Source, unit_of

UNKNOWN_SOURCE = "representative value, source not established"
"""Source of numbers whose origin is unknown."""

_FOLDER = files("castx.materials") / "database"
_ABOUT = ("summary", "class")
_KEYS = ("value", "unit", "source", "valid")
_PHASES = ("solid", "liquid")


@dataclass(frozen=True)
class Entry:
    """A material of the database.

    Args:
        summary: the material in one line.
        material_class: the group it belongs to.
        description: its properties.
        sources: by property, of a phase as `heat_capacity.solid`.
    """

    summary: str
    material_class: str
    description: MaterialDescription
    sources: dict[str, Source]


@cache
def database_names() -> tuple[str, ...]:
    """Return the names of all entries in alphabetical order."""
    names = (file.name for file in _FOLDER.iterdir())
    return tuple(sorted(name.removesuffix(".toml") for name in names if name.endswith(".toml")))


@cache
def database_entry(name: str) -> Entry:
    """Read one entry.

    Args:
        name: one of `database_names()`.

    Raises:
        CaseError: the file is not right; with its name, the keys, their values and the cure.
    """
    file = _FOLDER / f"{name}.toml"
    try:
        content = tomllib.loads(file.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise CaseError(f"{file}: {error}") from None
    return read_entry(content, str(file))


def read_entry(content: dict[str, Any], file: str) -> Entry:
    """Return the entry of a database file.

    Args:
        content: of the file.
        file: its name, for messages.

    Raises:
        CaseError: a property without unit, source or range, or refused; with all problems.
    """
    problems = list(_format_problems(content))
    if problems:
        raise CaseError(summary(file, problems, content))
    properties = {key: _plain(item) for key, item in content.items() if key not in _ABOUT}
    sources = {".".join(path): _source(item) for path, item in _items(content)}
    try:
        description = MaterialDescription.read(properties)
    except Refusal as refusal:
        raise CaseError(summary(file, refusal.problems, properties)) from None
    return Entry(content["summary"], content["class"], description, sources)


def _is_item(value: Any) -> bool:
    """Whether a table is a property rather than a table of properties."""
    return not isinstance(value, dict) or not all(isinstance(v, dict) for v in value.values())


def _items(content: dict[str, Any]) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield the properties of a file with the keys that lead to them."""
    for key, item in content.items():
        if key not in _ABOUT and _is_item(item):
            yield (key,), item
        elif key not in _ABOUT:
            yield from (((key, inner), part) for inner, part in item.items())


def _plain(item: Any) -> Any:
    """Return a property as a case file gives it."""
    return item["value"] if _is_item(item) else {key: part["value"] for key, part in item.items()}


def _source(item: dict[str, Any]) -> Source:
    valid = item.get("valid")
    return Source(item["source"], None if valid is None else (float(valid[0]), float(valid[1])))


def _format_problems(content: dict[str, Any]) -> Iterator[Problem]:
    """Yield mistakes in the form of a file, whatever its numbers are."""
    for key in _ABOUT:
        if not isinstance(content.get(key), str) or not content[key]:
            yield Problem((key,), "missing; a text in quotes is needed")
    for path, item in _items(content):
        if not isinstance(item, dict):
            text = 'a table is needed: { value = ..., unit = "...", source = "...", valid = [..] }'
            yield Problem(path, text)
            continue
        for key in set(item) - set(_KEYS):
            yield Problem((*path, key), f"unknown key; {among(key, _KEYS, what='known keys')}")
        if "value" not in item:
            yield Problem((*path, "value"), "missing; this key is needed")
        if not isinstance(item.get("source"), str) or not item["source"]:
            text = f"missing; author, year and table or equation, or {UNKNOWN_SOURCE!r}"
            yield Problem((*path, "source"), text)
        unit = unit_of(".".join(path))
        if unit is not None and item.get("unit", "") != unit.si:
            cure = f'must be "{unit.si}"; convert the numbers'
            yield Problem((*path, "unit"), cure if unit.si else "a pure number has none")
        yield from _range_problems(path, item)


def _range_problems(path: KeyPath, item: dict[str, Any]) -> Iterator[Problem]:
    """Yield mistakes in the temperatures between which a property is valid."""
    value, valid = item.get("value"), item.get("valid")
    rows = value if isinstance(value, list) and path[0] != "solid_fraction" else []
    if valid is None:
        if rows or path[-1] in _PHASES:
            yield Problem((*path, "valid"), "missing; the lowest and highest °C, as [20, 600]")
        return
    numbers = isinstance(valid, list) and all(isinstance(end, int | float) for end in valid)
    if not numbers or len(valid) != 2 or not ABSOLUTE_ZERO <= valid[0] < valid[1]:
        yield Problem((*path, "valid"), "two increasing temperatures in °C are needed")
        return
    for index, row in enumerate(rows):
        at = row[0] if isinstance(row, list) and row else None
        if isinstance(at, int | float) and not valid[0] <= at <= valid[1]:
            text = f"outside valid = {valid}; widen it or leave the row out"
            yield Problem((*path, "value", index), text)
