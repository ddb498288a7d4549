"""The tables of a case as groups of fields, with the values that its text gives them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from castx.app.forms.keys import FormKey, definition, keys_of
from castx.app.text.editing import value_of
from castx.case.cad.geometry import CadGeometry
from castx.case.geometry import GENERATORS
from castx.input.problems import KeyPath, dotted
from castx.input.toml_written import toml_value
from castx.materials.database import database_names
from castx.meshes.generators.declaration import COMMON_ARGUMENTS
from castx.transfer.database import interface_names

Answer = dict[str, Any]
TITLE = "Case"
"""Of the group of keys before all tables."""


def groups_of(content: Mapping[str, Any]) -> Iterator[Answer]:
    """Yield the groups of a case, for JSON.

    Args:
        content: keys and values of the file.
    """
    keys = keys_of(None)
    schema = definition(None)["properties"]
    plain = [key for key in keys if key.table is None and key.entries is None]
    plain = [key for key in plain if schema[key.name].get("type") != "object"]
    yield group_of((), TITLE, "", plain, content)
    for key in keys:
        given = content.get(key.name)
        if key.table is not None:
            yield from _of_table((key.name,), key, given)
        elif key.entries is not None:
            for index, entry in enumerate(given if isinstance(given, list) else []):
                yield from _of_table((key.name, index), key, entry)


def lists_of() -> list[Answer]:
    """Return the lists of tables to which the page can add one, with the keys of an entry."""
    return [
        {
            "name": key.name, "meaning": key.meaning,
            "fields": [field_of((), one, {}) for one in keys_of(key.entries) if one.table is None],
        }
        for key in keys_of(None)
        if key.entries is not None
    ]  # fmt: skip


def _of_table(path: KeyPath, key: FormKey, given: Any, within: str = "") -> Iterator[Answer]:
    name = key.table or key.entries
    content = given if isinstance(given, Mapping) else {}
    keys = [one for one in keys_of(name) if _matters(name, one, content)]
    said = str(definition(name).get("description", "")).split("\n\n")[0]
    title = f"{within}, {path[-1]}" if within else title_of(path, content)
    yield group_of(path, title, said, keys, content)
    for one in keys:
        if one.table is not None:
            yield from _of_table((*path, one.name), one, content.get(one.name), title)


def group_of(
    path: KeyPath, title: str, meaning: str, keys: list[FormKey], content: Mapping[str, Any]
) -> Answer:
    """Return a table with its fields, for JSON.

    Args:
        path: that leads to it.
        title: what the page calls it.
        meaning: of the table.
        keys: of it.
        content: its keys and values.
    """
    return {
        "path": list(path), "title": title, "meaning": meaning, "given": bool(content),
        "fields": [field_of(path, key, content) for key in keys if key.table is None],
    }  # fmt: skip


def field_of(path: KeyPath, key: FormKey, content: Mapping[str, Any]) -> Answer:
    """Return a key as a field, for JSON.

    Args:
        path: of its table.
        key: of the table.
        content: keys and values of the table.
    """
    given = key.name in content
    return {
        "path": [*path, key.name], "key": dotted((*path, key.name)), "name": key.name,
        "meaning": key.meaning, "words": list(key.words), "default": key.default,
        "needed": key.needed, "given": given,
        "value": shown(content[key.name], key.text) if given else "",
    }  # fmt: skip


def shown(value: Any, text: bool) -> str:
    """Return a value as a field shows it: texts without quotes where they are read back as such.

    Args:
        value: of the file.
        text: whether the field holds texts alone.
    """
    if isinstance(value, str) and (text or value_of(value.strip()) == value):
        return value
    return toml_value(value)


def suggestions(content: Mapping[str, Any]) -> dict[str, list[str]]:
    """Return names that suit a key beside others, by the name of the key.

    Args:
        content: keys and values of the file.
    """
    own = content.get("materials")
    bodies = content.get("bodies")
    names = [str(body.get("name")) for body in bodies if isinstance(body, Mapping)] if isinstance(
        bodies, list) else []  # fmt: skip
    return {
        "material": [*(own if isinstance(own, Mapping) else ()), *database_names()],
        "from": list(interface_names()),
        "body": names,
    }


def title_of(path: KeyPath, content: Mapping[str, Any]) -> str:
    """Return the title of a table on the page, such as "bodies 2: mould".

    Args:
        path: that leads to it.
        content: its keys and values.
    """
    words = [str(part + 1) if isinstance(part, int) else part for part in path]
    called = next((content[k] for k in ("name", "on", "bodies", "at") if k in content), None)
    if isinstance(called, list):
        called = "/".join(str(part) for part in called)
    named = isinstance(path[-1], int) and called is not None
    return " ".join(words) + (f": {called}" if named else "")


def _matters(name: str | None, key: FormKey, content: Mapping[str, Any]) -> bool:
    """Return whether a key may stand in a table: those of geometries depend on their sort."""
    if name != "Geometry" or key.name in content:
        return True
    if "generator" in content:
        generator = GENERATORS.get(str(content["generator"]))
        arguments = {} if generator is None else generator.arguments
        return key.name in {"generator", "model", *COMMON_ARGUMENTS, *arguments}
    if str(content.get("file", "")).endswith(".msh"):
        return key.name in ("file", "model")
    return key.name in {"model", *CadGeometry.model_fields}
