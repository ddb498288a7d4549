"""JSON schema of the keys of a case file, for completion in editors and forms."""

from __future__ import annotations

import re
from inspect import getdoc
from typing import Any

from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue

_ATTRIBUTE = re.compile(r"^    (\w+): (.+(?:\n {8}.+)*)", re.MULTILINE)
_UNIT = re.compile(r" \[[^\]]*\](?=$|;)")


class EntrySchema(GenerateJsonSchema):
    """Schema of descriptions whose entries are read by functions.

    An entry whose kind has `json_schema()` has that; of all others anything is allowed, since the
    reading of the case says more than a schema can. Each key is described by what the docstring
    of its description says of it, and its kind.
    """

    def emit_warning(self, kind: Any, detail: str) -> None:
        """Say nothing: defaults that JSON does not know are left out."""

    def function_plain_schema(self, schema: Any) -> JsonSchemaValue:
        """Return the schema of an entry that a function reads."""
        kind = getattr(schema["function"]["function"], "__self__", None)
        said = getattr(kind, "json_schema", None)
        return {} if said is None else dict(said())

    def is_instance_schema(self, schema: Any) -> JsonSchemaValue:
        """Return the schema of an entry of a class of its own: anything."""
        return {}

    def model_schema(self, schema: Any) -> JsonSchemaValue:
        """Return the schema of a description, with a meaning beside each key."""
        found = super().model_schema(schema)
        described = schema["cls"]
        told = meanings(described)
        for name, field in described.model_fields.items():
            entry = found["properties"].get(field.alias or name)
            if entry is not None and name in told:
                entry["description"] = _described(told[name], entry.get("description"))
        return found


def meanings(described: type) -> dict[str, str]:
    """Return the meanings of attributes by the docstring of a description, each in one line."""
    _, _, attributes = (getdoc(described) or "").partition("Attributes:\n")
    found = _ATTRIBUTE.findall(attributes)
    return {
        name: re.sub(r"\s+", " ", text).rstrip(".").replace("None: ", "left out: ")
        for name, text in found
    }


def _described(meaning: str, kind: str | None) -> str:
    """Return the meaning of a key with its kind, whose unit need not be said twice."""
    if not kind:
        return meaning
    return f"{_UNIT.sub('', meaning) if '[' in kind else meaning} ({kind})"
