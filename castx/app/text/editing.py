"""Changes of the text of a case file that leave its comments and its order alone."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from typing import Any

from castx.app.text.toml_lines import TextPlace, places
from castx.errors import CaseError
from castx.input.problems import KeyPath, dotted
from castx.input.toml_text import parse_toml
from castx.input.toml_written import toml_key, toml_value


def with_value(text: str, path: KeyPath, value: Any) -> str:
    """Return the text of a case file with a value set or taken away.

    Args:
        text: of the file.
        path: keys and indices that lead to the value; a table on the way may be missing.
        value: of the types of JSON; None: the key is taken away.

    Raises:
        CaseError: the text is no TOML, or writes the place in a way that the page does not change.
    """
    before = content_of(text)
    wanted = deepcopy(before)
    _set(wanted, path, value)
    if wanted == before:
        return text
    return _proved(_changed(text, wanted, path, value), wanted, path)


def with_entry(text: str, name: str, entry: Mapping[str, Any]) -> str:
    """Return the text of a case file with a further entry of a list of tables.

    Args:
        text: of the file.
        name: of the list, as `boundaries`.
        entry: keys and values.

    Raises:
        CaseError: the text is no TOML, or has a list that the page cannot add to.
    """
    wanted = content_of(text)
    if not isinstance(wanted.setdefault(name, []), list):
        raise CaseError(f"{name} is no list of tables")
    wanted[name].append(dict(entry))
    lines = text.splitlines()
    begun = [place for place in places(text) if place.is_table and place.path[:1] == (name,)]
    at = _end_of(lines, begun[-1]) if begun else len(lines)
    block = ["", f"[[{name}]]", *(f"{toml_key(k)} = {toml_value(v)}" for k, v in entry.items())]
    new = "\n".join([*lines[:at], *block, *_apart(lines[at:])]) + "\n"
    return _proved(new, wanted, (name,))


def content_of(text: str) -> dict[str, Any]:
    """Return the content of a case file.

    Raises:
        CaseError: it is no TOML.
    """
    try:
        return parse_toml(text)
    except ValueError as error:
        raise CaseError(f"the text is no TOML, mend it first: {error}") from None


def value_of(text: str) -> Any:
    """Return a value as TOML reads it, else as a text: 20, "20 degC" or 20 degC."""
    try:
        return content_of(f"it = {text}")["it"]
    except CaseError:
        return text


def _set(content: Any, path: KeyPath, value: Any) -> None:
    for key in path[:-1]:
        if isinstance(content, dict):
            content = content.setdefault(key, {})
        elif isinstance(content, list) and isinstance(key, int) and key < len(content):
            content = content[key]
        else:
            raise CaseError(f"{dotted(path)}: nothing leads there")
    last = path[-1]
    if isinstance(content, dict):
        if value is None:
            content.pop(last, None)
        else:
            content[last] = value
    elif isinstance(content, list) and isinstance(last, int) and last < len(content):
        content[last] = value
    else:
        raise CaseError(f"{dotted(path)}: nothing leads there")


def _changed(text: str, wanted: dict[str, Any], path: KeyPath, value: Any) -> str:
    lines, found = text.splitlines(), places(text)
    written = [p for p in found if not p.is_table and p.path and p.path == path[: len(p.path)]]
    tables = [p for p in found if p.path == path[: len(p.path)] and (p.is_table or not p.path)]
    nearest = max(tables, key=lambda place: len(place.path))
    if written:
        place = max(written, key=lambda place: len(place.path))
        if place.path == path and value is None:
            return "\n".join([*lines[: place.first], *lines[place.last :]]) + "\n"
        before = _at(content_of(text), place.path)
        new = _rewritten(lines, place, before, _at(wanted, place.path))
        return "\n".join([*lines[: place.first], new, *lines[place.last :]]) + "\n"
    inside = [str(key) for key in path[len(nearest.path) :]]
    at = _end_of(lines, nearest)
    line = f"{toml_key(inside[-1])} = {toml_value(value)}"
    if len(inside) == 1:
        return "\n".join([*lines[:at], line, *lines[at:]]) + "\n"
    names = [toml_key(key) for key in path[:-1] if isinstance(key, str)]
    if not nearest.path:
        at = len(lines)
    block = ["", f"[{'.'.join(names)}]", line]
    return "\n".join([*lines[:at], *block, *_apart(lines[at:])]) + "\n"


def _apart(lines: Sequence[str]) -> list[str]:
    """Return lines with an empty one before them."""
    return ["", *lines] if lines and lines[0].strip() else list(lines)


def _at(content: Any, path: KeyPath) -> Any:
    for key in path:
        content = content[key]
    return content


def _end_of(lines: Sequence[str], place: TextPlace) -> int:
    """Return the line behind a table, before the blanks and comments of the next one."""
    at = place.last
    while at > place.first + place.is_table:
        last = lines[at - 1].strip()
        if last and not last.startswith("#"):
            break
        at -= 1
    return at


def _rewritten(lines: Sequence[str], place: TextPlace, before: Any, value: Any) -> str:
    """Return the line of a value with another one, and the comment behind it.

    Where the comment names what has changed, such as the entry of a database, it follows.
    """
    first, last = lines[place.first], lines[place.last - 1]
    key = first[: _equals(first)].rstrip()
    comment = ""
    if place.last == place.first + 1:
        for at, letter in enumerate(last):
            if letter == "#" and _is_toml(last[:at]):
                comment = last[len(last[:at].rstrip()) :]
                break
    for old, new in _renamed(before, value):
        comment = new.join(re.split(rf"(?<![\w-]){re.escape(old)}(?![\w-])", comment))
    return f"{key} = {toml_value(value)}{comment}"


def _renamed(before: Any, value: Any) -> Iterator[tuple[str, str]]:
    """Yield texts of a value, or inside of it, that have become other texts."""
    if isinstance(before, str) and isinstance(value, str):
        if before and before != value:
            yield before, value
    elif isinstance(before, dict) and isinstance(value, dict):
        for key in before.keys() & value.keys():
            yield from _renamed(before[key], value[key])


def _equals(line: str) -> int:
    """Return the place of the sign between key and value; quoted keys may hold one too."""
    for at, letter in enumerate(line):
        if letter == "=" and _is_toml(f"{line[:at]} = 0"):
            return at
    raise CaseError(f"no key and value: {line}")


def _is_toml(text: str) -> bool:
    try:
        tomllib.loads(text)
    except ValueError:
        return False
    return True


def _proved(new: str, wanted: dict[str, Any], path: KeyPath) -> str:
    """Return a new text if it says what is wanted and nothing else."""
    try:
        if parse_toml(new) == wanted:
            return new
    except ValueError:
        pass
    raise CaseError(
        f"{dotted(path)} is written in a way that the page does not change; change it in the text"
    )
