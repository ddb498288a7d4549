"""Heat transfer that names an entry of the database: its keys, changed by those given beside it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from castx.input.entries import Description
from castx.input.problems import among, refuse
from castx.transfer.database import interface_entry, interface_names
from castx.transfer.keys import (
    CLOSED,
    COATING,
    GAS_CONDUCTIVITY,
    OPEN,
    PRESSURE,
    ROUGH,
    ROUGHNESS,
)
from castx.transfer.registry import gap_heat_laws

FROM = "from"
"""Key of a case file that names the entry."""

_ROUGH = frozenset(key.name for key in ROUGH)
_TABLES = (COATING.name, PRESSURE.name)


def with_entry(heat: Mapping[str, Any]) -> dict[str, Any]:
    """Return a heat transfer with the keys of the entry that it names written out.

    Written out once more it stays as it is. Without the key `from` it is returned as it stands.

    Args:
        heat: keys and values as in a case file.

    Raises:
        Refusal: there is no entry of this name.
    """
    if FROM not in heat:
        return dict(heat)
    name = heat[FROM]
    if not isinstance(name, str) or name not in interface_names():
        near = name if isinstance(name, str) else ""
        raise refuse(f"no such interface; {among(near, interface_names())}", FROM)
    return changed(interface_entry(name).heat, heat)


def changed(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return a heat transfer with some of its keys changed.

    Of a coating or a pressure term single keys can be changed. What a change takes the place of is
    left out: another law leaves out what it does not take, `closed` roughness and coating and the
    other way round, `open` the conductivity of the gas and the other way round.

    Args:
        base: keys and values.
        changes: those that are different.
    """
    merged = {**base, **changes}
    for key in _TABLES:
        parts = [_keys_of(values.get(key)) for values in (base, changes)]
        if all(parts):
            merged[key] = {**parts[0], **parts[1]}
    left_out = _left_out(merged, set(changes))
    return {key: value for key, value in merged.items() if key in changes or key not in left_out}


def _keys_of(value: Any) -> dict[str, Any]:
    """Return the keys of a table, read or as written; none of anything else."""
    if isinstance(value, Description):
        return {key: getattr(value, key) for key in value.model_fields_set}
    return dict(value) if isinstance(value, Mapping) else {}


def _left_out(merged: Mapping[str, Any], given: set[str]) -> set[str]:
    """Return the keys replaced by given ones, and keys without use in the law."""
    left_out: set[str] = set()
    term = _keys_of(merged.get(PRESSURE.name))
    if not term or {"resistance", *_ROUGH} & set(term):  # else its resistance is that of the pair
        if CLOSED.name in given:
            left_out |= _ROUGH
        elif given & _ROUGH:
            left_out.add(CLOSED.name)
    name = merged.get("law")
    law = gap_heat_laws().get(name) if isinstance(name, str) else None
    if law is None:
        return left_out
    left_out |= set(merged) - {"law", "patches", FROM} - {key.name for key in law.keys}
    if OPEN.name in given:
        left_out |= {key.name for key in law.instead.get(OPEN, ())}
    elif GAS_CONDUCTIVITY.name in given and OPEN in law.instead:
        left_out.add(OPEN.name)
    filled = ROUGHNESS.name in term or ROUGHNESS.name in set(merged) - left_out
    if filled:
        left_out.discard(GAS_CONDUCTIVITY.name)
    elif GAS_CONDUCTIVITY not in law.needed:
        left_out.add(GAS_CONDUCTIVITY.name)
    return left_out
