"""Actions on the forms of a case: what they show, and changes that the case file gets."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from castx.app.forms.groups import groups_of, lists_of, suggestions
from castx.app.forms.keys import FormKey, keys_of
from castx.app.text.arguments import Asked, text_of
from castx.app.text.editing import content_of, value_of, with_entry, with_value
from castx.errors import CaseError
from castx.input.problems import KeyPath

Answer = dict[str, Any]
DEEPEST = 12
"""Keys and indices of a path."""


def shown_forms(asked: Asked) -> Answer:
    """Return the groups of fields of a text, and the lists that can get an entry."""
    content = content_of(text_of(asked, "text"))
    return {
        "groups": list(groups_of(content)), "lists": lists_of(),
        "suggested": suggestions(content),
    }  # fmt: skip


def with_field(asked: Asked) -> str:
    """Return the text of a case in which a key has the value of its field, or is taken away.

    Raises:
        CaseError: there is no such key, or the text writes it in a way that cannot be changed.
    """
    path = path_of(asked)
    written = text_of(asked, "value").strip()
    value = None if written == "" else read_field(key_at(path), written)
    return with_value(text_of(asked, "text"), path, value)


def with_added(asked: Asked) -> str:
    """Return the text of a case with a further entry of a list.

    Raises:
        CaseError: there is no such list or key, or nothing was filled in.
    """
    name, values = text_of(asked, "list"), asked.get("values")
    lists = {key.name: key for key in keys_of(None) if key.entries is not None}
    if name not in lists:
        raise CaseError(f"a case has no list {name!r}")
    if not isinstance(values, Mapping):
        raise CaseError("the page has sent no values")
    known = {key.name: key for key in keys_of(lists[name].entries)}
    entry = {}
    for key in known.values():  # in the order of the schema
        text = values.get(key.name)
        if isinstance(text, str) and text.strip():
            entry[key.name] = read_field(key, text.strip())
    missing = [key.name for key in known.values() if key.needed and key.name not in entry]
    if missing:
        raise CaseError(f"{name}: fill in {', '.join(missing)}")
    return with_entry(text_of(asked, "text"), name, entry)


def read_field(key: FormKey, written: str) -> Any:
    """Return the value of a field: a text as it is, else as TOML reads it.

    Args:
        key: of the field.
        written: in it.
    """
    if key.text and written.startswith('"') and written.endswith('"') and len(written) > 1:
        return value_of(written)
    return written if key.text else value_of(written)


def path_of(asked: Asked) -> KeyPath:
    """Return the path of a key.

    Raises:
        CaseError: it is none.
    """
    path = asked.get("keys")
    wrong = not isinstance(path, list) or not 1 <= len(path) <= DEEPEST or any(
        isinstance(part, bool) or not isinstance(part, str | int) for part in path
    )  # fmt: skip
    if wrong:
        raise CaseError("the page has sent no path of a key")
    assert isinstance(path, list)
    return tuple(path)


def key_at(path: KeyPath) -> FormKey:
    """Return the key of a case to which a path leads.

    Raises:
        CaseError: there is none.
    """
    table: str | None = None
    found: FormKey | None = None
    for part in path:
        if isinstance(part, int):
            if found is None or found.entries is None or part < 0:
                raise CaseError(f"a case has no entry {part}")
            table = found.entries
            continue
        if found is not None and table is None:
            raise CaseError(f"{found.name} has no key {part!r}")
        found = next((key for key in keys_of(table) if key.name == part), None)
        if found is None:
            raise CaseError(f"a case has no key {part!r}")
        table = found.table
    if found is None or isinstance(path[-1], int):
        raise CaseError("the page has sent no path of a key")
    return found
