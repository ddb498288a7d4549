"""The materials that come with castx: `database/NAME.toml`.

Every property there is a table { value = as in a case file, source = text, valid = [°C, °C] };
`valid` is left out where the value is no function of temperature.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from castx.errors import CaseError
from castx.materials.description import MaterialDescription
from castx.materials.sources import Source

_FOLDER = files("castx.materials") / "database"
_PHASES = ("solid", "liquid")


@dataclass(frozen=True)
class Entry:
    """A material of the database.

    Args:
        summary: what it is, in one line.
        description: its properties.
        sources: by property; those of a phase as `heat_capacity.solid`.
    """

    summary: str
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
        CaseError: the file is not right; with its name and what is wrong.
    """
    file = _FOLDER / f"{name}.toml"
    try:
        return read_entry(tomllib.loads(file.read_text(encoding="utf-8")))
    except (CaseError, tomllib.TOMLDecodeError) as error:
        raise CaseError(f"{file}: {error}") from None


def read_entry(content: dict[str, Any]) -> Entry:
    """Return the entry that a database file holds.

    Raises:
        CaseError: a property without source, or refused.
    """
    properties, sources = {}, {}
    for key, item in content.items():
        if key == "summary":
            continue
        if isinstance(item, dict) and set(item) <= set(_PHASES):
            sources.update({f"{key}.{phase}": _source(key, item[phase]) for phase in item})
            properties[key] = {phase: item[phase]["value"] for phase in item}
        else:
            sources[key] = _source(key, item)
            properties[key] = item["value"]
    description = MaterialDescription.read(properties)
    return Entry(str(content.get("summary", "")), description, sources)


def _source(key: str, item: Any) -> Source:
    if not isinstance(item, dict) or not {"value", "source"} <= set(item):
        raise CaseError(f"{key}: needs value and source, and valid where it varies")
    valid = item.get("valid")
    return Source(item["source"], None if valid is None else (float(valid[0]), float(valid[1])))
