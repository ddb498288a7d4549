"""Keys of the case file that have new names: the old ones are read for one minor version."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

from castx.input.problems import KeyPath, Problem, Refusal, dotted
from castx.version import __version__

ANY = "*"
"""Stands in a path for every key of a table whose keys are names, such as `materials`."""
_PATH = re.compile(r"((\w+|\*)\.)*\w+")
_NAME = re.compile(r"\w+")


@dataclass(frozen=True)
class ChangedKey:
    """New name of a key; it stays in its table, and its value means what it meant.

    Args:
        old: path of the key up to now, such as "interfaces.heat.closed", where a list stands for
            all its entries, and `ANY` for all names.
        new: its name from now on, without the table.
        since: the minor version that brings the new name, such as "0.2".

    Raises:
        ValueError: the names are the same, or no names, or no version is given.
    """

    old: str
    new: str
    since: str

    def __post_init__(self) -> None:
        if not _PATH.fullmatch(self.old) or not _NAME.fullmatch(self.new):
            text = "a path such as a.b and a name are needed"
            raise ValueError(f"{self.old!r}, {self.new!r}: {text}")
        if self.new == self.name:
            raise ValueError(f"{self.old} already has the name {self.new}")
        if not re.fullmatch(r"\d+\.\d+", self.since):
            raise ValueError(f"{self.old}: {self.since!r} is no minor version such as 0.2")

    @property
    def table(self) -> list[str]:
        """Keys that lead to the table."""
        return self.old.split(".")[:-1]

    @property
    def name(self) -> str:
        """Old name in the table."""
        return self.old.rpartition(".")[2]

    def is_read(self, version: str) -> bool:
        """Return whether a version reads the old name; a later minor version refuses it."""
        return _minor(version) <= _minor(self.since)

    def is_over(self, version: str) -> bool:
        """Return whether the entry can go: the version after the one that refuses it has come."""
        major, minor = _minor(self.since)
        return _minor(version) > (major, minor + 1) and _minor(version) != (major + 1, 0)


CHANGED_KEYS: tuple[ChangedKey, ...] = ()
"""All keys with new names; `CHANGELOG.md` names them too."""


def with_new_names(
    data: Mapping[str, Any],
    changed: Sequence[ChangedKey] = CHANGED_KEYS,
    version: str = __version__,
) -> tuple[dict[str, Any], list[str]]:
    """Return the content of a case under the new names of its keys, and a warning of each old name.

    Args:
        data: keys and values of a case file.
        changed: keys with new names.
        version: that reads them.

    Raises:
        Refusal: an old name is no longer read, or stands beside the new one.
    """
    result = deepcopy(dict(data))
    warnings, problems = [], []
    for key in changed:
        places = [place for place in _tables(result, key.table) if key.name in place[1]]
        problems += [
            Problem((*path, key.name), text)
            for path, table in places
            if (text := _refused(key, table, version))
        ]
        if places and not problems:
            warnings.append(_warning(key, [path for path, _ in places]))
        for _, table in places:
            table[key.new] = table.pop(key.name)
    if problems:
        raise Refusal(problems)
    return result, warnings


def _refused(key: ChangedKey, table: Mapping[str, Any], version: str) -> str:
    """Return why an old name cannot be read; "" if it can."""
    if key.new in table:
        return f"is the old name of {key.new}, which is there too; leave the old one out"
    if not key.is_read(version):
        return f"is called {key.new} since castx {key.since}; change the name, the value stays"
    return ""


def _warning(key: ChangedKey, tables: Sequence[KeyPath]) -> str:
    place = dotted((*tables[0], key.name))
    more = f" (and {len(tables) - 1} more)" if len(tables) > 1 else ""
    return (
        f"{place}{more} is called {key.new} since castx {key.since}; change the name, the value "
        "stays: the next minor version refuses the old one"
    )


def _tables(
    value: Any, keys: Sequence[str], path: KeyPath = ()
) -> Iterator[tuple[KeyPath, dict[str, Any]]]:
    """Yield the tables to which keys lead, each with its path."""
    if isinstance(value, list | tuple):
        for index, item in enumerate(value):
            yield from _tables(item, keys, (*path, index))
    elif isinstance(value, dict) and not keys:
        yield path, value
    elif isinstance(value, dict):
        for key in value if keys[0] == ANY else keys[:1]:
            yield from _tables(value.get(key), keys[1:], (*path, key))


def _minor(version: str) -> tuple[int, int]:
    major, minor = version.split(".")[:2]
    return int(major), int(minor)

