"""Where the last liquid of each casting is, step by step: at last where it freezes last."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.case.case import Case
from castx.foundry.stress.extremes import largest
from castx.materials.lookup import find_material
from castx.stateful import Arrays, Saved

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh

TIE = 1e-9
"""Difference of solid fractions that counts as none."""
FULLY_SOLID = 1.0 - 1e-6
"""Solid fraction from which a node counts as solid."""


class HeatedState(Protocol):
    """The part of a state after an accepted step that is needed here."""

    @property
    def time(self) -> float:
        """End of the step [s]."""

    @property
    def mesh(self) -> CastingMesh:
        """The bodies that are there."""

    def nodal(self, body: str, name: str, /) -> FloatArray:
        """Return temperature or solid_fraction with ghosts."""


class LastLiquid:
    """The node that is least solid, and the hottest of these, as long as there is liquid.

    Args:
        mesh: of all bodies.
        castings: bodies to follow.
    """

    def __init__(self, mesh: CastingMesh, castings: Sequence[str]) -> None:
        self._mesh = mesh
        self._points = {body: mesh.bodies[body].points for body in castings}
        self._found = {body: np.full(1 + mesh.parent.geometry.dim, np.nan) for body in castings}

    def update(self, state: HeatedState) -> None:
        """Take over the state after an accepted step; collective."""
        for body in self._found:
            if body not in state.mesh.bodies:
                continue
            owned = self._mesh.bodies[body].nodes.dofmap.index_map.size_local
            solid = np.asarray(state.nodal(body, "solid_fraction"))[:owned]
            least = self._mesh.comm.allreduce(float(solid.min(initial=np.inf)), op=MPI.MIN)
            if least < FULLY_SOLID:
                temperature = np.asarray(state.nodal(body, "temperature"))[:owned]
                place = self._hottest(body, temperature, solid <= least + TIE)
                self._found[body] = np.array([state.time, *place])

    def _hottest(self, body: str, temperature: FloatArray, chosen: BoolArray) -> Sequence[float]:
        here = np.flatnonzero(chosen)
        numbers = self._mesh.bodies[body].original_nodes[here]
        points = self._points[body][here]
        return list(largest(self._mesh.comm, temperature[here], numbers, points)["place"])

    def field(self, body: str, name: str) -> None:
        """Return nothing: there is no field of it."""

    def totals(self) -> dict[str, float]:
        """Return nothing: there is no column of it."""
        return {}

    def described(self) -> dict[str, Any]:
        """Return time [s] and place [m] of the last state with liquid, by casting."""
        return {
            body: {"time": float(found[0]), "place": found[1:].tolist()}
            for body, found in self._found.items()
            if np.isfinite(found[0])
        }

    def saved(self) -> dict[str, Saved]:
        """Return times and places."""
        return {body: Saved(found) for body, found in self._found.items()}

    def restore(self, arrays: Arrays) -> None:
        """Go on with the places of an earlier part of the run."""
        self._found |= {body: arrays[body].copy() for body in self._found if body in arrays}


def last_liquid_of(case: Case, mesh: CastingMesh) -> LastLiquid:
    """Return the last liquid of the bodies of a case that are liquid at first."""
    materials: Mapping[str, Any] = case.materials
    castings = [
        body.name
        for body in case.bodies
        if case.coupling.scheme != "mechanical"
        and not body.starts_solid(find_material(body.material, materials).description)
    ]
    return LastLiquid(mesh, castings)
