"""Where the metal of a body freezes, at nodes or inside cells, if its case leaves that to castx."""

from __future__ import annotations

from castx.case.bodies import AT_NODES, AUTOMATIC, DARCY, IN_CELLS, Body
from castx.case.case import Case
from castx.materials.lookup import find_material


def with_freezing(case: Case) -> tuple[Body, ...]:
    """Return the bodies with the freezing that suits them in place of "automatic".

    An alloy that is poured and comes to bear stress freezes inside cells, unless its fractions need
    not be those of its temperature: where a part freezes at one temperature, or where melt flows
    through mush.

    Args:
        case: the case as it was read.
    """
    found = []
    for body in case.bodies:
        if body.freezing == AUTOMATIC:
            freezing = IN_CELLS if _freezes_in_cells(case, body) else AT_NODES
            body = body.model_copy(update={"freezing": freezing})
        found.append(body)
    return tuple(found)


def _freezes_in_cells(case: Case, body: Body) -> bool:
    metal = find_material(body.material, case.materials)
    if case.coupling.scheme == "thermal" or body.law == "rigid":
        return False
    if metal.plateaus or body.feeding == DARCY or touches_perfectly(case, body):
        return False
    return body.is_poured(metal)


def touches_perfectly(case: Case, body: Body) -> bool:
    """Return whether a body has the temperature of another one at their interface, from the start.

    The wall of a melt then jumps to that temperature. Inside cells that would free the latent heat
    of metal whose own nodes stay as they are: of iron in sand 7 % of all heat came from nowhere.

    Args:
        case: the case as it was read.
        body: one of its bodies.
    """
    return any(
        body.name in interface.bodies
        and interface.heat is not None
        and interface.heat.declared.exchange == "perfect"
        for interface in case.interfaces
    )
