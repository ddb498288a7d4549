"""Clamped surfaces of a case for the mechanics, and clamps that would press on nothing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from mpi4py import MPI

import numpy as np

from castx.case.boundaries import Boundary
from castx.case.case import Case
from castx.domain.mesh import BodyMesh, CastingMesh
from castx.errors import CaseError
from castx.mechanics.clamp import SurfaceClamp, clamp_directions
from castx.mechanics.fixed_directions import (
    SurfaceDisplacement,
    axes_of,
    fixed_directions,
    parallel,
)
from castx.tables import Table


def surface_clamps(boundaries: Iterable[Boundary], model: str) -> list[SurfaceClamp]:
    """Return the clamps among the conditions on one body.

    Args:
        boundaries: conditions on the body.
        model: geometric model.
    """
    found, axes = [], axes_of(model)
    for boundary in boundaries:
        clamp = boundary.clamp
        if clamp is not None:
            force = Table.constant(0.0) if clamp.force is None else clamp.force
            axis = axes.get(clamp.direction or "")
            found.append(
                SurfaceClamp(boundary.surface, force, clamp.stiffness or 0.0, axis, clamp.is_frame)
            )
    return found


def refuse_held_clamps(
    case: Case, mesh: CastingMesh, displacements: dict[str, list[SurfaceDisplacement]]
) -> None:
    """Refuse clamps without a direction, and clamps whose surface cannot move; collective.

    Args:
        case: of one stage.
        mesh: of its bodies.
        displacements: conditions by body.

    Raises:
        CaseError: a surface is not flat or faces another direction, or all of it has a prescribed
            displacement along the clamp.
    """
    if case.coupling.scheme == "thermal":
        return
    for body in case.bodies:
        own = [boundary for boundary in case.boundaries if boundary.body == body.name]
        for clamp in surface_clamps(own, mesh.model):
            part = mesh.bodies[body.name]
            if _is_held(part, mesh.model, clamp, displacements[body.name]):
                raise CaseError(
                    f"boundary '{body.name}/{clamp.surface}', clamp: displacement conditions "
                    "prescribe the motion of the whole surface along it, so that force and "
                    "stiffness would have no effect; leave out the clamp or the displacement "
                    '("uniform" makes the plate of the machine rigid)'
                )


def _is_held(
    body: BodyMesh, model: str, clamp: SurfaceClamp, conditions: Sequence[SurfaceDisplacement]
) -> bool:
    directions, _ = clamp_directions(body, model, clamp)
    owned = body.nodes.dofmap.index_map.size_local
    nodes = body.surface_nodes(clamp.surface)
    free = np.zeros((len(directions), owned), dtype=bool)
    free[:, nodes[nodes < owned]] = True
    for fixed in fixed_directions(body, model, conditions):
        for along, direction in zip(free, directions, strict=True):
            if fixed.value is not None:
                along[fixed.nodes[parallel(fixed.directions, np.asarray(direction))]] = False
    return not body.mesh.comm.allreduce(bool(free.any()), op=MPI.LOR)
