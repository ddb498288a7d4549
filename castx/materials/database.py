"""The materials that come with castx: `database/NAME.toml`.

Every property there is a table { value, unit, source, valid }, one level deeper for a phase, for
`hardening` and for `liquid`: the value as in a case file, its SI unit (left out of pure numbers),
author, year and table or equation, and the lowest and highest temperature [°C] for which it is
valid (left out where it does not depend on temperature). Where no source is known, it says so.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from castx.errors import CaseError
from castx.input.problems import KeyPath, Problem, Refusal, summary
from castx.input.sourced import (
    entry_names,
    file_content,
    item_problems,
    items,
    plain,
    text_problems,
)
from castx.input.units import ABSOLUTE_ZERO
from castx.materials.description import MaterialDescription
from castx.materials.sources import Source, unit_of

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
    return entry_names(_FOLDER)


@cache
def database_entry(name: str) -> Entry:
    """Read an entry of the database.

    Args:
        name: one of `database_names()`.

    Raises:
        CaseError: the file is not right; with its name, the keys, their values and the cure.
    """
    file = _FOLDER / f"{name}.toml"
    return read_entry(file_content(file), str(file))


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
    properties = {key: plain(item) for key, item in content.items() if key not in _ABOUT}
    sources = {".".join(path): _source(item) for path, item in items(content, _ABOUT)}
    try:
        description = MaterialDescription.read(properties)
    except Refusal as refusal:
        raise CaseError(summary(file, refusal.problems, properties)) from None
    return Entry(content["summary"], content["class"], description, sources)


def _source(item: dict[str, Any]) -> Source:
    valid = item.get("valid")
    return Source(item["source"], None if valid is None else (float(valid[0]), float(valid[1])))


def _format_problems(content: dict[str, Any]) -> Iterator[Problem]:
    """Yield mistakes in the form of a file, whatever its numbers are."""
    yield from text_problems(content, _ABOUT)
    for path, item in items(content, _ABOUT):
        unit = unit_of(".".join(path))
        yield from item_problems(path, item, _KEYS, None if unit is None else unit.si)
        if isinstance(item, dict):
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
