"""The content of a case with the numbers that it takes from the database of interfaces."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from castx.transfer.naming import with_entry


def written_out(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the content of a case with the entries written out that its interfaces name.

    So the records of a run keep the numbers that were used, and a run does not go on with others.

    Args:
        data: keys and values of a case that has been accepted.
    """
    if "interfaces" not in data:
        return dict(data)
    return {**data, "interfaces": [_interface(interface) for interface in data["interfaces"]]}


def _interface(interface: Mapping[str, Any]) -> dict[str, Any]:
    heat = interface.get("heat")
    return {**interface, "heat": _heat(heat)} if isinstance(heat, Mapping) else dict(interface)


def _heat(heat: Mapping[str, Any]) -> dict[str, Any]:
    keys = with_entry(heat)
    if "patches" in keys:
        keys["patches"] = [with_entry(patch) for patch in keys["patches"]]
    return keys
