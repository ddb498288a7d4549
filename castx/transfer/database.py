"""The interfaces that come with castx: `database/NAME.toml`.

Every key there is a table { value, unit, range, source }, one level deeper for `coating`,
`pressure` and `radiation`: the value as in a case file, its SI unit (left out of pure numbers), the
lowest and highest number that practice has, of a list one such pair for each of its numbers, and
what was read. Where no source is known, it says so. The law has a source and no range.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any, NamedTuple, get_args

from pydantic.fields import FieldInfo

from castx.errors import CaseError
from castx.input.entries import Description, Quantity
from castx.input.problems import KeyPath, Problem, among, summary
from castx.input.sourced import (
    entry_names,
    file_content,
    item_problems,
    items,
    plain,
    text_problems,
)
from castx.input.variation import Varying
from castx.transfer.registry import gap_heat_laws, law_keys

Range = tuple[float, float]

_FOLDER = files("castx.transfer") / "database"
_ABOUT = ("summary", "alloy", "mould", "layer", "process")
_KEYS = ("value", "unit", "range", "source")
_LAW = ("law",)


class SourcedNumber(NamedTuple):
    """A key of an entry, with all that is known of it.

    Args:
        name: dotted, as `coating.thickness`.
        value: as a case file gives it.
        unit: SI, as people write it; "" of pure numbers.
        ranges: lowest and highest number of practice; one for all numbers, or for each its own.
        source: what was read, or that it is not known.
    """

    name: str
    value: Any
    unit: str
    ranges: tuple[Range, ...]
    source: str


@dataclass(frozen=True)
class InterfaceEntry:
    """An interface of the database.

    Args:
        summary: the interface in one line.
        alloy: class of the metal that is cast.
        mould: what it touches.
        layer: what lies between them, as a coating.
        process: how it is cast.
        heat: the heat transfer as a case file gives it.
        numbers: the keys of `heat`, each with unit, range and source.
    """

    summary: str
    alloy: str
    mould: str
    layer: str
    process: str
    heat: dict[str, Any]
    numbers: tuple[SourcedNumber, ...]


@cache
def interface_names() -> tuple[str, ...]:
    """Return the names of all interfaces in alphabetical order.

    >>> import castx
    >>> "aluminium-steel-coated" in castx.interface_names()
    True
    """
    return entry_names(_FOLDER)


@cache
def interface_entry(name: str) -> InterfaceEntry:
    """Read an interface of the database.

    Raises:
        CaseError: there is none of this name, or its file is not right; with the keys, their
            values and the cure.
    """
    if name not in interface_names():
        raise CaseError(f"unknown interface {name!r}; {among(name, interface_names())}")
    file = _FOLDER / f"{name}.toml"
    return read_interface(file_content(file), str(file))


def read_interface(content: dict[str, Any], file: str) -> InterfaceEntry:
    """Return the interface of a database file.

    Args:
        content: of the file.
        file: its name, for messages.

    Raises:
        CaseError: a key without unit, range or source, or one that the law does not take.
    """
    problems = list(_format_problems(content))
    if problems:
        raise CaseError(summary(file, problems, content))
    heat = {key: plain(item) for key, item in content.items() if key not in _ABOUT}
    numbers = tuple(
        SourcedNumber(
            ".".join(path), item["value"], item.get("unit", ""), _ranges(item), item["source"]
        )
        for path, item in items(content, _ABOUT)
    )
    return InterfaceEntry(heat=heat, numbers=numbers, **{key: content[key] for key in _ABOUT})


def plain_numbers(value: Any) -> list[float]:
    """Return the numbers of a key: one, all of a list, or the coefficients of a table."""
    if isinstance(value, dict):
        return [row[1] for row in value["table"]]
    return list(value) if isinstance(value, list) else [value]


def _ranges(item: dict[str, Any]) -> tuple[Range, ...]:
    """Return the ranges of a number, of each number of a list."""
    if "range" not in item:
        return ()
    each = item["range"] if isinstance(item["value"], list) else [item["range"]]
    return tuple((float(low), float(high)) for low, high in each)


def _format_problems(content: dict[str, Any]) -> Iterator[Problem]:
    yield from text_problems(content, _ABOUT)
    law = gap_heat_laws().get(plain(content.get("law", {"value": None})))
    if law is None:
        laws = among("", list(gap_heat_laws()), what="laws")
        yield Problem(("law", "value"), f"missing or unknown; {laws}")
        return
    known = ["law", *(key.name for key in law.keys)]
    for path, item in items(content, _ABOUT):
        if path[0] not in known:
            yield Problem(path, f"the law {law.name!r} does not take it; {among(path[0], known)}")
            continue
        yield from item_problems(path, item, _KEYS, "" if path == _LAW else unit_of(path))
        if isinstance(item, dict) and path != _LAW:
            yield from _range_problems(path, item)


def _range_problems(path: KeyPath, item: dict[str, Any]) -> Iterator[Problem]:
    """Yield a range that is missing or does not hold the numbers."""
    try:
        numbers, ranges = plain_numbers(item["value"]), _ranges(item)
        found = bool(ranges) and all(low < high for low, high in ranges)
        each = ranges if isinstance(item["value"], list) else ranges * len(numbers)
        holds = all(low <= x <= high for x, (low, high) in zip(numbers, each, strict=True))
    except (KeyError, TypeError, ValueError):
        found, holds = False, True
    if not found:
        text = "missing; the lowest and highest number, as [800, 3000], or of a list one for each"
        yield Problem((*path, "range"), text)
    elif not holds:
        yield Problem((*path, "value"), f"outside range = {item['range']}; widen it")


def unit_of(path: KeyPath) -> str | None:
    """Return the SI unit of a key of a gap heat law as people write it; None: no such key."""
    keys = law_keys(gap_heat_laws())
    kind: object = keys[str(path[0])].entry if path[0] in keys else None
    for name in path[1:]:
        model = next(_descriptions(kind), None)
        kind = model.model_fields.get(str(name)) if model is not None else None
    quantity = next(_quantities(kind), None)
    if quantity is None:
        return None
    return quantity.dimension.unit.translate(str.maketrans("*", " ")).replace("^2", "²")


def _parts(kind: object) -> tuple[object, ...]:
    """Return the constituent types of a type or field."""
    if isinstance(kind, FieldInfo):
        return (*kind.metadata, kind.annotation)
    return get_args(kind)


def _quantities(kind: object) -> Iterator[Quantity]:
    if isinstance(kind, Quantity | Varying):
        yield kind if isinstance(kind, Quantity) else kind.value
    for part in _parts(kind):
        yield from _quantities(part)


def _descriptions(kind: object) -> Iterator[type[Description]]:
    if isinstance(kind, type) and issubclass(kind, Description):
        yield kind
    for part in _parts(kind):
        yield from _descriptions(part)
