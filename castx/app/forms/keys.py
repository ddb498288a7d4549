"""Keys of a case as fields of a form: meaning, kind, allowed words, default, from the schema."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from castx.case.case import Case
from castx.input.toml_written import toml_value

Schema = Mapping[str, Any]
_REFERENCE = "#/$defs/"


@dataclass(frozen=True)
class FormKey:
    """A key of a table.

    Attributes:
        name: as the file writes it.
        meaning: in words, with unit and range.
        words: that are allowed; empty: others than these few are too.
        default: as TOML writes it; "": there is none.
        needed: whether the key must be there.
        text: whether its value is a text, whatever it looks like.
        table: name of the definition of the table that it holds, if it holds one.
        entries: name of the definition of the tables that it lists, if it lists some.
    """

    name: str
    meaning: str
    words: tuple[str, ...]
    default: str
    needed: bool
    text: bool
    table: str | None
    entries: str | None


@cache
def case_schema() -> Schema:
    """Return the JSON schema of a case."""
    return Case.model_json_schema()


def definition(name: str | None) -> Schema:
    """Return the schema of a table by the name of its definition; None: of the whole case."""
    schema = case_schema()
    found: Schema = schema if name is None else schema["$defs"][name]
    return found


def keys_of(name: str | None) -> list[FormKey]:
    """Return the keys of a table, those that it must have first.

    Args:
        name: of its definition; None: of the whole case.
    """
    schema = definition(name)
    needed = schema.get("required", ())
    found = [form_key(key, entry, key in needed) for key, entry in schema["properties"].items()]
    return sorted(found, key=lambda key: not key.needed)


def form_key(name: str, entry: Schema, needed: bool) -> FormKey:
    """Return a key by its schema.

    Args:
        name: of the key.
        entry: its schema.
        needed: whether it must be there.
    """
    one = _one_kind(entry)
    default = entry.get("default")
    return FormKey(
        name,
        ", ".join(dict.fromkeys(_said(entry) + _said(one))),
        _words(one),
        "" if default in (None, "", [], {}) else toml_value(_whole(default)),
        needed,
        one.get("type") == "string",
        _referred(one),
        _referred(one.get("items", {})),
    )


def _whole(value: Any) -> Any:
    """Return a whole number without its fraction, as people write it."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _said(entry: Schema) -> list[str]:
    return [entry["description"]] if entry.get("description") else []


def _words(entry: Schema) -> tuple[str, ...]:
    if entry.get("type") == "boolean":
        return "true", "false"
    return tuple(str(word) for word in entry.get("enum", ()))


def _one_kind(entry: Schema) -> Schema:
    """Return the schema of a value that is there, of one that may also be left out."""
    kinds: list[Schema] = [kind for kind in entry.get("anyOf", ()) if kind.get("type") != "null"]
    return kinds[0] if len(kinds) == 1 else entry


def _referred(entry: Schema) -> str | None:
    reference = entry.get("$ref")
    return None if reference is None else str(reference).removeprefix(_REFERENCE)
