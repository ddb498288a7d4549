"""JSON schema of the keys of a case file, for completion in editors and forms."""

from __future__ import annotations

from typing import Any

from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue


class EntrySchema(GenerateJsonSchema):
    """Schema of descriptions whose entries are read by functions.

    An entry whose kind has `json_schema()` has that; of all others anything is allowed, since the
    reading of the case says more than a schema can.
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
