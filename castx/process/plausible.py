"""Displacements and interferences that no small-strain model can mean, refused before a run."""

from __future__ import annotations

from collections.abc import Iterator

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.case.case import Case
from castx.domain.mesh import CastingMesh
from castx.errors import CaseError

MOST = 0.5
"""Largest displacement or interference in sizes of a body that is not refused; a fifth of it is
already more than small displacements allow, which a run tells."""


def refuse_absurd_displacements(case: Case, mesh: CastingMesh) -> None:
    """Refuse prescribed displacements and interferences of the size of the body; collective.

    Rigid bodies may move as far as they like.

    Args:
        case: of one stage.
        mesh: of all bodies.

    Raises:
        CaseError: with place, value and size.
    """
    if case.coupling.scheme == "thermal":
        return
    sizes = {name: size_of(mesh, name) for name in mesh.bodies}
    for where, value, body in (*_displacements(case), *_interferences(case)):
        if body in case.rigid_bodies or value <= MOST * sizes[body]:
            continue
        raise CaseError(
            f"{where}: {value:g} m, and {body!r} is {sizes[body]:g} m large; displacements and "
            f"strains are taken as small, and more than {MOST:g} times the size is refused (is it "
            "in m?)"
        )


def size_of(mesh: CastingMesh, body: str) -> float:
    """Return the largest extent of a body along an axis [m]; collective."""
    points = mesh.bodies[body].points
    dimension = points.shape[1]
    # The lowest coordinates, and the highest ones negated.
    own: FloatArray = np.full(2 * dimension, np.inf)
    if len(points):
        own[:dimension], own[dimension:] = points.min(axis=0), -points.max(axis=0)
    both = np.empty_like(own)
    mesh.comm.Allreduce(own, both, MPI.MIN)
    return float((-both[dimension:] - both[:dimension]).max())


def _displacements(case: Case) -> Iterator[tuple[str, float, str]]:
    for boundary in case.boundaries:
        for condition in boundary.displacement:
            if condition.value is not None:
                where = f"boundary {boundary.on!r}, displacement {condition.direction}"
                yield where, float(np.abs(condition.value.values).max()), boundary.body


def _interferences(case: Case) -> Iterator[tuple[str, float, str]]:
    for interface in case.interfaces:
        for body in interface.bodies:
            where = f"interface {interface.name!r}, initial_gap: an interference"
            yield where, -float(interface.contact.initial_gap.table.values.min()), body
