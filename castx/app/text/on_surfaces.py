"""What the text of a case file says of surfaces: their conditions, and who feeds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from castx.app.text.editing import content_of, with_entry, with_value
from castx.input.problems import KeyPath, dotted
from castx.input.toml_written import toml_value


def with_condition(text: str, on: str, key: str, value: Any) -> str:
    """Return the text of a case with a condition on a surface, in place of one of its sort.

    Args:
        text: of the case.
        on: body and surface.
        key: of the condition, as `heat`.
        value: of the key.
    """
    for index, entry in enumerate(_tables(content_of(text), "boundaries")):
        if entry.get("on") == on:
            return with_value(text, ("boundaries", index, key), value)
    return with_entry(text, "boundaries", {"on": on, key: value})


def with_feeder(text: str, on: str) -> str:
    """Return the text of a case with a surface among those that feed.

    Args:
        text: of the case.
        on: body and surface.
    """
    given = _table(content_of(text), "foundry").get("feeders")
    before = given if isinstance(given, list) else []
    return text if on in before else with_value(text, ("foundry", "feeders"), [*before, on])


def with_surface_moved(text: str, old: str, new: str) -> str:
    """Return the text of a case in which what was said of a surface is said of another one.

    Args:
        text: of the case.
        old: body and surface.
        new: body and surface, of which nothing is said yet.
    """
    for path, on in surfaces_named(content_of(text)):
        if on == old:
            text = with_value(text, path, new)
    return text


def surfaces_named(content: Mapping[str, Any]) -> Iterator[tuple[KeyPath, str]]:
    """Yield the keys that name a surface "body/surface", and the surface.

    Args:
        content: keys and values of a case.
    """
    for index, entry in enumerate(_tables(content, "boundaries")):
        yield from _named(("boundaries", index, "on"), entry.get("on"))
    for stage, table in enumerate(_tables(content, "stages")):
        for index, entry in enumerate(_tables(table, "boundaries")):
            yield from _named(("stages", stage, "boundaries", index, "on"), entry.get("on"))
    foundry = _table(content, "foundry")
    for key in ("feeders", "flat"):
        listed = foundry.get(key)
        for index, on in enumerate(listed if isinstance(listed, list) else ()):
            yield from _named(("foundry", key, index), on)


def said_of(content: Mapping[str, Any], on: str) -> str:
    """Return the conditions of a surface as the case file writes them; "": there is none.

    Args:
        content: keys and values of a case.
        on: body and surface.
    """
    found = [
        f"{key} = {toml_value(value)}"
        for entry in _tables(content, "boundaries")
        if entry.get("on") == on
        for key, value in entry.items()
        if key != "on"
    ]
    fed = any(path[:2] == ("foundry", "feeders") for path, one in surfaces_named(content)
              if one == on)  # fmt: skip
    return "; ".join([*found, "feeds"] if fed else found)


def lost_surfaces(content: Mapping[str, Any], known: Mapping[str, object]) -> dict[str, str]:
    """Return why keys that name a surface without faces are wrong, by the surface.

    Args:
        content: keys and values of a case.
        known: surfaces "body/surface" that have faces.
    """
    found = {}
    for path, on in surfaces_named(content):
        if on not in known:
            body = on.partition("/")[0]
            there = [name for name in known if name.partition("/")[0] == body]
            has = f"{body} has {', '.join(there)}" if there else f"there is no body {body!r}"
            found[on] = f"{dotted(path)}: no face has this name; {has}"
    return found


def _named(path: KeyPath, on: object) -> Iterator[tuple[KeyPath, str]]:
    if isinstance(on, str) and "/" in on:
        yield path, on


def _table(content: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    found = content.get(name)
    return found if isinstance(found, Mapping) else {}


def _tables(content: Mapping[str, Any], name: str) -> list[Mapping[str, Any]]:
    """Return a list of tables; what is no table is an empty one, so that indices count all."""
    found = content.get(name)
    listed = found if isinstance(found, list) else []
    return [entry if isinstance(entry, Mapping) else {} for entry in listed]
