"""The same case with another coherency of its alloys."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from castx.case.case import Case
from castx.case.coherency import coherencies
from castx.case.reading.read import read_case
from castx.errors import CaseError
from castx.materials.description import Liquid
from castx.materials.lookup import find_material
from castx.materials.sources import numbers

LEAST = 0.01
"""Coherency that a smaller one becomes: it has to be above zero."""


def with_coherency(case: Case, shift: float) -> Case:
    """Return the case with the coherency of its alloys moved, and kept within (0, 1].

    The materials of a case are rewritten as `--set` would do it, so that records and results of
    the other case are those of a case file.

    Args:
        case: that was read from a file.
        shift: of the coherency of each body that has one.

    Raises:
        CaseError: no body has a coherency.
    """
    found = coherencies(case)
    if not found:
        raise CaseError(why_none(case))
    content = case.content
    materials: dict[str, Any] = dict(content.get("materials", {}))
    for coherency in found:
        liquid = find_material(coherency.material, case.materials).liquid
        assert liquid is not None
        own: Mapping[str, Any] = materials.get(coherency.material, {"extends": coherency.material})
        moved = min(max(coherency.value + shift, LEAST), 1.0)
        materials[coherency.material] = {**own, "liquid": {**_keys(liquid), "coherency": moved}}
    return read_case(content | {"materials": materials}, case.path, f"with coherency {shift:+g}")


def why_none(case: Case) -> str:
    """Return why a case has no coherency to move."""
    if case.coupling.scheme == "thermal":
        return 'with scheme = "thermal" nothing bears, so that no answer hangs on coherency'
    return (
        "no body has a coherency: it belongs to an alloy that starts molten and has a liquid; "
        "metal that freezes at one temperature has no mush"
    )


def _keys(liquid: Liquid) -> dict[str, Any]:
    """Return the keys of a liquid as a case file gives them, in SI."""
    return {name: _plain(getattr(liquid, name)) for name in liquid.model_fields_set}


def _plain(value: Any) -> Any:
    """Return a word or a number as it is, and the rows of a table."""
    rows = [list(row) for row in numbers(value)]
    return rows[0][1] if len(rows) == 1 and rows[0][0] is None else rows
