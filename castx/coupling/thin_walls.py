"""Walls of a mesh with few cells across them, body by body."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from castx.case.case import Case
from castx.coupling.building import formulation_of
from castx.domain.mesh import CastingMesh
from castx.domain.walls import Walls
from castx.foundry.bending import ENOUGH, ThinWalls, bending_error, freezing_error
from castx.materials.granular import GRANULAR
from castx.materials.lookup import find_material

SEEN = 0.05
"""Part of a surface from which thin walls are named: edges and fillets have some by chance."""
SMALL_ERROR = 0.03
"""Error of a deflection up to which nothing is said."""


def thin_walls(case: Case, mesh: CastingMesh) -> Iterator[ThinWalls]:
    """Yield the thin walls of each body of metal that has some and moves, with few cells across.

    Raises:
        CaseError: cells or model do not have the formulation of a body.
    """
    if case.coupling.scheme == "thermal":
        return
    for body in case.bodies:
        # Of sand, nobody asks how it bends.
        if body.law in ("rigid", GRANULAR):
            continue
        kind = mesh.bodies[body.name].kind
        free = mesh.walls[body.name].free_of(_held(case, body.name))
        formulation, cells = formulation_of(mesh, body), (kind.name, kind.plural)
        freezes = body.is_poured(find_material(body.material, case.materials))
        found = _of_body(free, body.name, formulation, cells, freezes=freezes)
        if found is not None:
            yield found


def _held(case: Case, body: str) -> set[str]:
    """Return the surfaces of a body at which it cannot bend: held flat, or tied to another."""
    flat = {
        boundary.surface
        for boundary in case.boundaries
        if boundary.body == body
        and any(item.direction in ("normal", "all") for item in boundary.displacement)
    }
    tied = (
        set(interface.bodies)
        for interface in case.interfaces
        if interface.contact.method == "tied" and body in interface.bodies
    )
    return flat.union(*tied) - {body}


def thin_wall_records(case: Case, mesh: CastingMesh) -> dict[str, dict[str, Any]]:
    """Return the thin walls of each body that has some, by its name, as run.json has them."""
    return {found.body: asdict(found) for found in thin_walls(case, mesh)}


def _of_body(
    walls: Walls, body: str, formulation: str, kind: tuple[str, str], *, freezes: bool
) -> ThinWalls | None:
    """Return the thin walls of a body; None: none, or its cells do well.

    Args:
        walls: of the body.
        body: its name.
        formulation: of its mechanics.
        kind: of its cells, and its plural.
        freezes: whether it is poured.
    """
    few = ENOUGH - 0.5
    one, two, all_few = (walls.share(limit) for limit in (1.5, 2.5, few))
    if all_few < SEEN:
        return None
    across = walls.quantile(walls.cells, 0.5, few)
    error, fine = (bending_error(formulation, kind[0], count) for count in (across, ENOUGH))
    if error is None or abs(error) <= SMALL_ERROR:
        error = fine = None
    freezing, freezing_if_fine = (
        freezing_error(formulation, count) if freezes else None for count in (across, ENOUGH)
    )
    if error is None and freezing is None:
        return None
    low, high = (walls.quantile(walls.thickness, share, few) for share in (0.1, 0.9))
    return ThinWalls(
        body, kind[1], formulation, one, two, all_few, low, high, across, error, fine, freezing,
        freezing_if_fine,
    )  # fmt: skip
