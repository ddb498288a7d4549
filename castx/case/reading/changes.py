"""Differences between a case and that of a checkpoint, and whether a run may go on with it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from castx.case.reading.changed_keys import CHANGED_KEYS, ChangedKey, with_new_names
from castx.errors import CaseError
from castx.input.problems import KeyPath, Refusal, dotted, show, summary

ALLOWED: tuple[KeyPath, ...] = (
    ("name",),
    ("time", "end"),
    ("time", "smallest_step"),
    ("coupling", "passes"),
    ("output",),
    ("foundry",),
    ("probes",),
    ("measurements",),
    ("solver",),
)
"""Keys that may change between two parts of a run: neither the model nor the steps taken."""
KEPT: tuple[KeyPath, ...] = (("output", "format"),)
"""Keys among them that may not: files are begun in one format."""

ABSENT = object()


def refuse_changes(
    before: Mapping[str, Any],
    now: Mapping[str, Any],
    source: str,
    changed: Sequence[ChangedKey] = CHANGED_KEYS,
) -> None:
    """Refuse to go on with a case whose model or steps have changed.

    Args:
        before: keys and values of the case of the checkpoint.
        now: those of the case.
        source: the checkpoint, for the message.
        changed: keys with new names, which an earlier version wrote under their old ones.

    Raises:
        CaseError: lists the keys that differ and may not.
    """
    try:
        before, _ = with_new_names(before, changed)
    except Refusal as refusal:
        raise CaseError(summary(source, refusal.problems, before)) from None
    changes = [
        f"{dotted(path)} = {_shown(new)} (it was {_shown(old)})"
        for path, old, new in differences(with_tables(before), with_tables(now))
        if path in KEPT or not any(path[: len(allowed)] == allowed for allowed in ALLOWED)
    ]
    if changes:
        allowed, kept = (", ".join(dotted(path) for path in paths) for paths in (ALLOWED, KEPT))
        raise CaseError(
            f"the case is not the one of {source}; it differs in\n  "
            + "\n  ".join(changes)
            + f"\na run may go on with changes of {allowed} (not {kept}) only; undo the others, or "
            "run the case anew without --restart, in another folder (--output) to keep these "
            "results"
        )


def with_tables(case: Mapping[str, Any]) -> dict[str, Any]:
    """Return a case with an empty table for each that it lacks and of which a key may change.

    Args:
        case: its keys and values.
    """
    tables = {str(path[0]) for path in (*ALLOWED, *KEPT) if len(path) > 1}
    empty: dict[str, Any] = {name: {} for name in sorted(tables)}
    return empty | dict(case)


def differences(old: Any, new: Any, path: KeyPath = ()) -> Iterator[tuple[KeyPath, Any, Any]]:
    """Yield path, old and new value of each difference, also inside lists of tables."""
    if isinstance(old, Mapping) and isinstance(new, Mapping):
        for key in [*old, *(key for key in new if key not in old)]:
            yield from differences(old.get(key, ABSENT), new.get(key, ABSENT), (*path, key))
    elif _are_tables(old) and _are_tables(new):
        for index in range(max(len(old), len(new))):
            before, now = (
                values[index] if index < len(values) else ABSENT for values in (old, new)
            )
            yield from differences(before, now, (*path, index))
    elif old is not new and old != new:
        yield path, old, new


def _are_tables(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(item, Mapping) for item in value)


def _shown(value: Any) -> str:
    return "absent" if value is ABSENT else show(value)
