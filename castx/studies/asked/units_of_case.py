"""Units of the numbers of a case, by what the case says that it takes at a path."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from typing import Any

from castx.case.case import Case
from castx.input.overrides import value_at
from castx.studies.asked.inputs import VariedInput
from castx.studies.asked.known import keys_of
from castx.transfer.conditions.registry import heat_conditions
from castx.transfer.declaration import HeatKey

_UNIT = re.compile(r"(?<!\[)\[([^\[\],]+)\]")
"""In the description of a key; rows of tables, such as [[a time, value], …], are none."""
_REFERENCE = "#/$defs/"


def unit_at(content: Mapping[str, Any], of: str) -> str:
    """Return the SI unit of a number of a case, "" of a plain one or if nothing tells it.

    Args:
        content: keys and values of the case.
        of: path of the number, as `--set` takes it.
    """
    keys = keys_of(of)
    if keys[:1] == ["boundaries"] and "heat" in keys:
        return _of_condition(content, keys)
    unit, schema = "", _schema()
    for key in keys:
        found = _below(schema, key)
        if found is None:
            break
        schema, unit = found, _described(found) or unit
    return unit


def shown_unit(content: Mapping[str, Any], one: VariedInput) -> str:
    """Return the unit in which the values of an input are shown; "" of factors and plain numbers.

    Args:
        content: keys and values of the case.
        one: the input.
    """
    return one.unit or ("" if one.factor else unit_at(content, one.of))


def _of_condition(content: Mapping[str, Any], keys: list[str]) -> str:
    """Return the unit of a number of a heat condition, by the type that it has."""
    kind = value_at(content, ".".join([*keys[:-1], "type"]))
    declared = heat_conditions().get(str(kind))
    found = [key for key in (declared.keys if declared else ()) if key.name == keys[-1]]
    return _of_key(found[0]) if found else ""


def _of_key(key: HeatKey[Any]) -> str:
    entry: Any = key.entry
    dimension = getattr(getattr(entry, "value", entry), "dimension", None)
    return "" if dimension is None else str(dimension.shown)


@cache
def _schema() -> Mapping[str, Any]:
    return Case.model_json_schema()


def _below(schema: Mapping[str, Any], key: str) -> Mapping[str, Any] | None:
    """Return the schema of a key, of an entry of a list or of a name; None: there is none."""
    for one in _kinds(schema):
        found = one.get("items") if key.isdigit() else one.get("properties", {}).get(key)
        found = found or one.get("additionalProperties")
        if isinstance(found, Mapping):
            return found
    return None


def _kinds(schema: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Return the schemas of all kinds that a value may be of, with references followed."""
    return [
        _schema()["$defs"][one["$ref"].removeprefix(_REFERENCE)] if "$ref" in one else one
        for one in schema.get("anyOf", [schema])
    ]


def _described(schema: Mapping[str, Any]) -> str:
    """Return the unit that the description of a key names, or that of one of its kinds."""
    for one in (schema, *schema.get("anyOf", ())):
        match = _UNIT.search(one.get("description", ""))
        if match is not None:
            return match[1]
    return ""
