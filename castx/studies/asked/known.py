"""What a case and the databases below it have at a path, and between which ends it may lie."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from castx.case.case import STUDIES
from castx.errors import CaseError
from castx.input.overrides import value_at
from castx.input.problems import among
from castx.materials.database import database_entry, database_names, database_value
from castx.materials.lookup import LONGEST_CHAIN
from castx.studies.asked.amounts import amount
from castx.studies.asked.inputs import VariedInput
from castx.transfer.database import interface_entry, interface_names

SPREADS = ("low", "high", "mean", "deviation", "values")
"""Keys of an input that say how it is spread."""


class KnownRange(NamedTuple):
    """The range of a number in a database.

    Args:
        low: lowest number in SI, or factor.
        high: highest one.
        by_factor: whether they multiply what is there.
        of: the entry.
        source: of the range.
    """

    low: float
    high: float
    by_factor: bool
    of: str
    source: str


def entry_below(data: Mapping[str, Any], path: Sequence[str]) -> str | None:
    """Return the entry of a database below a number of the case, None where there is none.

    A material is below `materials.NAME` by `extends`, unless a material of the case on the way has
    the property itself; an interface below `interfaces.INDEX.heat` by `from`.

    Args:
        data: the content of the case.
        path: keys of the number.
    """
    if len(path) > 2 and path[0] == "materials":
        name = path[1]
        for _ in range(LONGEST_CHAIN):
            own = value_at(data, f"materials.{name}")
            if not isinstance(own, dict) or path[2] in own:
                return None
            parent = own.get("extends")
            if parent in database_names() and (
                parent == name or parent not in data.get("materials", {})
            ):
                return str(parent)
            name = str(parent)
    if len(path) > 3 and path[0] == "interfaces" and path[2] == "heat":
        heat = value_at(data, ".".join(path[:3]))
        if isinstance(heat, dict) and path[3] not in heat and heat.get("from") in interface_names():
            return str(heat["from"])
    return None


def known_range(data: Mapping[str, Any], of: str) -> KnownRange | None:
    """Return the range that a database knows of a number of the case; None: it knows none.

    Args:
        data: the content of the case.
        of: path of the number, as `--set` takes it.
    """
    path = keys_of(of)
    entry = entry_below(data, path)
    if entry is None:
        return None
    if path[0] == "materials":
        source = database_entry(entry).sources.get(".".join(path[2:]))
        found = source.spread if source else None
        if found is None:
            return None
        return KnownRange(found.low, found.high, found.by_factor, entry, found.source)
    for number in interface_entry(entry).numbers:
        plain = isinstance(number.value, int | float)
        if number.name == ".".join(path[3:]) and plain and len(number.ranges) == 1:
            return KnownRange(*number.ranges[0], False, entry, number.source)
    return None


def refuse_elsewhere(data: Mapping[str, Any], of: str) -> None:
    """Refuse a path that leads to no number of a case, but that a case would take.

    Any name may follow `materials`, so that a mistyped one would be a further material that
    nothing is made of; and what a study says of itself is no part of what its runs are.

    Args:
        data: the content of the case.
        of: path of the number, as `--set` takes it.

    Raises:
        CaseError: it leads to another material than those of the case, to one that nothing is made
            of, or into a study.
    """
    path = keys_of(of)
    if path[0] == "materials" and len(path) > 1:
        names, inside = list(data.get("materials", {})), ".".join(path[1:])
        meant = [name for name in names if f"{inside}.".startswith(f"{name}.")]  # may have points
        if not meant:
            raise CaseError(
                f"of = {of!r}: the case has no [materials.{path[1]}]; {among(path[1], names)}; one "
                'of the database is varied by a material that extends it: extends = "NAME"'
            )
        if not any(_is_named(data, name) for name in meant):
            raise CaseError(
                f"of = {of!r}: nothing is made of [materials.{meant[0]}], so that no run would "
                f'change; give it to a body: material = "{meant[0]}"'
            )
    if path[0] in STUDIES:
        raise CaseError(f"of = {of!r}: [{path[0]}] is a study; a number of the case is needed")


def _is_named(data: Mapping[str, Any], material: str) -> bool:
    """Return whether a case names a material of its own, in studies and in itself apart."""
    others = {key: one for key, one in data["materials"].items() if key != material}
    waiting = [part for key, part in data.items() if key not in (*STUDIES, "materials")] + [others]
    while waiting:
        part = waiting.pop()
        if part == material:
            return True
        if isinstance(part, Mapping):
            waiting.extend(part.values())
        elif isinstance(part, list | tuple):
            waiting.extend(part)
    return False


def with_known_ranges(
    inputs: Sequence[Any], data: Mapping[str, Any]
) -> tuple[list[Any], list[str]]:
    """Return inputs of which those without a spread have that of a database, and words about them.

    Args:
        inputs: as they stand in the case file.
        data: the content of the case.
    """
    filled, words = [], []
    for one in inputs:
        bare = isinstance(one, dict) and isinstance(one.get("of"), str)
        found = known_range(data, one["of"]) if bare and not {*SPREADS} & {*one} else None
        if found is None:
            filled.append(one)
            continue
        ends = {"low": found.low, "high": found.high}
        filled.append({**one, **ends, **({"factor": True} if found.by_factor else {})})
        times = "times " if found.by_factor else ""
        words.append(
            f"{one['of']}: {times}{found.low:g} to {found.high:g}, the range of {found.of} "
            f"({found.source})"
        )
    return filled, words


def changes_of_case(
    data: Mapping[str, Any], inputs: Sequence[VariedInput], values: Sequence[float | str]
) -> dict[str, Any]:
    """Return the changes of a case by which its inputs have some values.

    A number inside a group that a database has, as the conductivity of the melt, comes with the
    rest of its group, since a case has a group as a whole.

    Args:
        data: the content of the case.
        inputs: what is varied.
        values: of the inputs, as a case file writes them, or factors.

    Raises:
        CaseError: there is nothing that a factor could multiply.
    """
    changes: dict[str, Any] = {}
    for one in inputs:
        path = keys_of(one.of)
        entry = entry_below(data, path)
        if entry is not None and path[0] == "materials" and len(path) > 3:
            group = database_value(entry, path[2:3])
            changes.setdefault(".".join(path[:3]), group)
    for one, value in zip(inputs, values, strict=True):
        changes[one.of] = _scaled_number(data, one.of, float(value)) if one.factor else value
    return {path: value for path, value in changes.items() if value is not None}


def _scaled_number(data: Mapping[str, Any], of: str, factor: float) -> Any:
    path = keys_of(of)
    there = value_at(data, of)
    entry = entry_below(data, path)
    if there is None and entry is not None and path[0] == "materials":
        there = database_value(entry, path[2:])
    if there is None:
        raise CaseError(f"{of}: there is nothing that a factor could multiply; give low and high")
    return scaled(there, factor)


def scaled(value: Any, factor: float) -> Any:
    """Return a number or a table, as a case file has it, times a factor.

    Raises:
        CaseError: it is neither.
    """
    if isinstance(value, dict) and "table" in value:
        return {**value, "table": scaled(value["table"], factor)}
    if isinstance(value, dict):
        return {key: scaled(part, factor) for key, part in value.items()}
    if isinstance(value, list):
        if not all(isinstance(row, list) and len(row) == 2 for row in value):
            raise CaseError("a factor multiplies a number or a table [[at, value], ...]")
        return [[at, scaled(number, factor)] for at, number in value]
    given = amount(value)
    return given.written(given.value * factor)


def keys_of(of: str) -> list[str]:
    """Return the keys of a path of a case file, lists by index."""
    return of.replace("[", ".").replace("]", "").split(".")
