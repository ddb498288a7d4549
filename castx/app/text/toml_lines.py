"""Where in the text of a case file a value stands."""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from castx.input.problems import KeyPath

_HEADER = re.compile(r"\s*(\[\[?)\s*(.+?)\s*\]\]?\s*(?:#.*)?$")
_ONE = r"""(?:[A-Za-z0-9_-]+|"[^"\n]*"|'[^'\n]*')"""
_KEY = re.compile(rf"\s*({_ONE}(?:\s*\.\s*{_ONE})*)\s*=")
_PART = re.compile(_ONE)


@dataclass(frozen=True)
class TextPlace:
    """Lines of a table or of a value.

    Attributes:
        path: keys and indices that lead to it.
        first: its first line, from 0.
        last: the line behind its last one.
        is_table: whether a heading begins it.
    """

    path: KeyPath
    first: int
    last: int
    is_table: bool


def places(text: str) -> list[TextPlace]:
    """Return the places of tables and of their values; the table before all has no heading.

    Args:
        text: of a case file, which must be TOML.
    """
    lines = text.splitlines()
    counts: Counter[tuple[str | int, ...]] = Counter()
    found: list[TextPlace] = []
    table: KeyPath = ()
    begun, at, heading = 0, 0, False
    while at < len(lines):
        header = _HEADER.match(lines[at])
        if header is not None:
            found.append(TextPlace(table, begun, at, heading))
            table, begun, heading = _table(header[1], header[2], counts), at, True
            at += 1
            continue
        key = _KEY.match(lines[at])
        if key is None:
            at += 1
            continue
        end = _end(lines, at)
        found.append(TextPlace((*table, *_parts(key[1])), at, end, False))
        at = end
    found.append(TextPlace(table, begun, len(lines), heading))
    return found


def line_of(text: str, path: Sequence[str | int]) -> int | None:
    """Return the line, from 1, of a value or of the nearest one that holds it; None: none does."""
    best: TextPlace | None = None
    for place in places(text):
        fits = place.path and place.path == tuple(path[: len(place.path)])
        if fits and (best is None or len(place.path) > len(best.path)):
            best = place
    return None if best is None else best.first + 1


def _table(brackets: str, name: str, counts: Counter[tuple[str | int, ...]]) -> KeyPath:
    """Return the path of a heading, with indices of the lists that it leads through."""
    path: tuple[str | int, ...] = ()
    parts = _parts(name)
    for number, part in enumerate(parts):
        path = (*path, part)
        last = number == len(parts) - 1
        if last and brackets == "[[":
            counts[path] += 1
        if counts[path]:
            path = (*path, counts[path] - 1)
    return path


def _parts(name: str) -> tuple[str, ...]:
    return tuple(part.strip("\"'") for part in _PART.findall(name))


def _end(lines: Sequence[str], first: int) -> int:
    """Return the line behind a value that may go over several lines."""
    for last in range(first + 1, len(lines) + 1):
        try:
            tomllib.loads("\n".join(lines[first:last]))
        except ValueError:
            continue
        return last
    return first + 1
