"""Heat conditions on surfaces."""

from __future__ import annotations

from typing import Any

from castx.case.boundaries import HeatCondition
from castx.heat.boundaries import SurfaceHeat
from castx.transfer.conditions.declaration import FluxLaw


def surface_heat(place: str, type: str, **numbers: Any) -> SurfaceHeat:
    """Return a condition on a surface.

    Args:
        place: "body/surface".
        type: of the condition.
        numbers: as a case gives them.
    """
    body, _, surface = place.partition("/")
    condition = HeatCondition.read({"type": type, **numbers})
    return SurfaceHeat(body=body, surface=surface, condition=condition)


def flux_law(type: str, **numbers: Any) -> FluxLaw:
    """Return the flux of a condition.

    Args:
        type: of the condition.
        numbers: as a case gives them.
    """
    condition = HeatCondition.read({"type": type, **numbers})
    flux = condition.declared.flux
    assert flux is not None
    return flux(condition.given)
