"""The output fields that a case can ask for, found in `castx/case/fields`."""

from __future__ import annotations

import pkgutil
from functools import cache
from importlib import import_module

import castx.case.fields as room
from castx.case.fields.declaration import FieldPlace, OutputField

OTHERS = ("declaration", "registry")


@cache
def output_fields() -> dict[str, OutputField]:
    """Return all fields by name, in the order of the alphabet.

    Raises:
        TypeError: a file declares no fields, a field lacks something, or two have one name.
    """
    found: dict[str, OutputField] = {}
    for module in sorted(info.name for info in pkgutil.iter_modules(room.__path__)):
        if module in OTHERS:
            continue
        fields = getattr(import_module(f"{room.__name__}.{module}"), "FIELDS", None)
        if not fields:
            raise TypeError(f"castx/case/fields/{module}.py declares no FIELDS")
        for field in fields:
            _enter(found, field, module)
    return dict(sorted(found.items()))


def _enter(found: dict[str, OutputField], field: OutputField, module: str) -> None:
    where = f"castx/case/fields/{module}.py: the field {field.name!r}"
    if missing := field.omissions():
        raise TypeError(f"{where} lacks {', '.join(missing)}")
    if field.name in found:
        raise TypeError(f"{where} is declared twice")
    found[field.name] = field


def probed(*places: FieldPlace) -> tuple[str, ...]:
    """Return the names of the fields at places that probes record."""
    fields = output_fields().values()
    return tuple(f.name for f in fields if f.dimension is not None and f.place in places)


def read_from_states(place: FieldPlace) -> tuple[str, ...]:
    """Return the names of the fields at a place that are read from a state."""
    return tuple(f.name for f in output_fields().values() if f.read and f.place is place)
