"""The materials that come with castx: `database/NAME.toml`.

Every property there is a table { value, unit, source, valid }, one level deeper for a phase, for
`hardening` and for `liquid`: the value as in a case file, its SI unit (left out of pure numbers),
author, year and table or equation, and the lowest and highest temperature [°C] for which it is
valid (left out where it does not depend on temperature). Where no source is known, it says so.
Beside them may stand in which `range` a number lies, or between which `factors` a table, and
`range_source`, where that comes from.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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
from castx.materials.sources import Source, Spread, unit_of

_FOLDER = files("castx.materials") / "database"
_ABOUT = ("summary", "class")
_KEYS = ("value", "unit", "source", "valid", "range", "factors", "range_source")
_SPREADS = {"range": False, "factors": True}
"""Keys of a spread, and whether they multiply."""
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


def database_value(name: str, path: Sequence[str]) -> Any:
    """Return a number, a table or several that belong together as a case file gives them.

    Args:
        name: of an entry.
        path: of keys, as ("conductivity", "liquid"); one that leads nowhere gives None.
    """
    found: Any = file_content(_FOLDER / f"{name}.toml").get(path[0])
    found = None if found is None or path[0] in _ABOUT else plain(found)
    for key in path[1:]:
        found = found.get(key) if isinstance(found, dict) else None
    return found


def _source(item: dict[str, Any]) -> Source:
    valid = item.get("valid")
    spread = None
    for key, by_factor in _SPREADS.items():
        if key in item:
            low, high = item[key]
            spread = Spread(float(low), float(high), by_factor, item["range_source"])
    at = None if valid is None else (float(valid[0]), float(valid[1]))
    return Source(item["source"], at, spread)


def _format_problems(content: dict[str, Any]) -> Iterator[Problem]:
    """Yield mistakes in the form of a file, whatever its numbers are."""
    yield from text_problems(content, _ABOUT)
    for path, item in items(content, _ABOUT):
        unit = unit_of(".".join(path))
        yield from item_problems(path, item, _KEYS, None if unit is None else unit.si)
        if isinstance(item, dict):
            yield from _valid_problems(path, item)
            yield from _spread_problems(path, item)


def _spread_problems(path: KeyPath, item: dict[str, Any]) -> Iterator[Problem]:
    """Yield mistakes in the range in which a property may lie."""
    given = [key for key in _SPREADS if key in item]
    if bool(given) != ("range_source" in item) or len(given) > 1:
        text = "belongs beside one of range = [low, high] or factors = [low, high]"
        yield Problem((*path, "range_source"), text)
        return
    for key in given:
        ends, value = item[key], item.get("value")
        middle = value if key == "range" else 1.0
        if not isinstance(middle, int | float):
            yield Problem((*path, key), "is of a single number; a table has factors")
        elif not _numbers(ends) or len(ends) != 2 or not ends[0] <= middle <= ends[1]:
            what = "the value" if key == "range" else "1"
            yield Problem((*path, key), f"two numbers are needed with {what} between them")
        elif not isinstance(item["range_source"], str) or not item["range_source"]:
            yield Problem((*path, "range_source"), "a text in quotes is needed")


def _numbers(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(one, int | float) for one in value)


def _valid_problems(path: KeyPath, item: dict[str, Any]) -> Iterator[Problem]:
    """Yield mistakes in the temperatures between which a property is valid."""
    value, valid = item.get("value"), item.get("valid")
    rows = value if isinstance(value, list) and path[0] != "solid_fraction" else []
    if valid is None:
        if rows or path[-1] in _PHASES:
            yield Problem((*path, "valid"), "missing; the lowest and highest °C, as [20, 600]")
        return
    if not _numbers(valid) or len(valid) != 2 or not ABSOLUTE_ZERO <= valid[0] < valid[1]:
        yield Problem((*path, "valid"), "two increasing temperatures in °C are needed")
        return
    for index, row in enumerate(rows):
        at = row[0] if isinstance(row, list) and row else None
        if isinstance(at, int | float) and not valid[0] <= at <= valid[1]:
            text = f"outside valid = {valid}; widen it or leave the row out"
            yield Problem((*path, "value", index), text)
