"""Heat conditions on surfaces."""

from __future__ import annotations

from typing import Any

from castx.case.boundaries import HeatCondition
from castx.heat.boundaries import SurfaceHeat


def surface_heat(place: str, kind: str, **numbers: Any) -> SurfaceHeat:
    """Return a condition on a surface.

    Args:
        place: "body/surface".
        kind: of the condition.
        numbers: as a case gives them.
    """
    body, _, surface = place.partition("/")
    condition = HeatCondition.read({"type": kind, **numbers})
    return SurfaceHeat(body=body, surface=surface, condition=condition)
