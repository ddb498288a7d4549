"""Warnings of displacements that are no longer small, and the end of a run where they are absurd.

Strains are taken as linear and positions as unchanged: the error of both is about as large as the
gradient of the displacement, and as the displacement in sizes of the body. A solid that froze
counts from there on: what it flowed as a liquid strains nothing, and liquid that sinks into a
feeder or fills what a skin leaves is where it ought to be.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray, IntArray
from castx.case.case import Case
from castx.domain.mesh import BodyMesh, CastingMesh
from castx.errors import ConvergenceError
from castx.foundry.front.gradients import midpoint_gradients
from castx.input.units import seconds_text
from castx.process.plausible import size_of
from castx.results.states.snapshot import FULLY_SOLID, Snapshot

_log = logging.getLogger(__name__)

TOLD = 0.1
"""Gradient, or displacement in sizes of the body, from which a run warns."""
ABSURD = 0.5
"""That at which it ends: the error is as large as the answer."""


@dataclass(frozen=True)
class _Cells:
    """Data for the gradients of displacements in the cells of a body."""

    nodes: IntArray
    gradients: FloatArray
    middles: FloatArray
    size: float


class DeformationWatch:
    """Warns once for each body whose displacements are not small, and ends absurd runs.

    Args:
        case: what is run.
        comm: ranks of the run; the first one warns.
    """

    def __init__(self, case: Case, comm: MPI.Intracomm) -> None:
        self._comm = comm
        rigid, thermal = case.rigid_bodies, case.coupling.scheme == "thermal"
        self._bodies = [b.name for b in case.bodies if not thermal and b.name not in rigid]
        self._freezes = case.coupling.scheme != "mechanical"
        self._stages = case.stages
        self._cells: dict[str, _Cells] = {}
        self._slopes_at_freezing: dict[str, FloatArray] = {}
        self._places_at_freezing: dict[str, FloatArray] = {}
        self._warned: set[str] = set()

    def check(self, snapshot: Snapshot) -> None:
        """Look at the displacements after an accepted step; collective.

        Raises:
            ConvergenceError: they are absurd; on all ranks.
        """
        for body in self._bodies:
            if body not in snapshot.mesh.bodies:
                continue
            gradient, place = self._steepest(snapshot, body)
            moved = self._largest(snapshot, body) / self._of(snapshot.mesh, body).size
            if max(gradient, moved) <= TOLD:
                continue
            text = (
                f"at t = {seconds_text(snapshot.time)} {body} is displaced by {100.0 * moved:.3g} "
                f"% of its size, its solid strained and turned by up to {100.0 * gradient:.3g} % "
                f"at ({', '.join(f'{x:.4g}' for x in place)}) m; displacements are taken as small"
            )
            if max(gradient, moved) > ABSURD:
                raise ConvergenceError(
                    f"{text}, and beyond {100.0 * ABSURD:g} % a run ends: look at displacement "
                    f"conditions, initial gaps, loads and supports{self._since(snapshot)}"
                )
            if body not in self._warned:
                self._warned.add(body)
                if self._comm.rank == 0:
                    _log.warning(
                        "%s, with errors of that order above %g %% (said once for each body)",
                        text, 100.0 * TOLD,
                    )  # fmt: skip

    def _since(self, snapshot: Snapshot) -> str:
        """Return words for the bodies that the last stage has removed, none if there are none."""
        number = snapshot.process.stage
        removed = self._stages[number - 1].remove if 0 < number <= len(self._stages) else ()
        if not removed:
            return ""
        return f", and at what holds the body since stage {number} has removed {', '.join(removed)}"

    def _steepest(self, snapshot: Snapshot, body: str) -> tuple[float, FloatArray]:
        """Return the largest gradient of the displacement in the solid of all ranks, and where."""
        cells = self._of(snapshot.mesh, body)
        displacement = snapshot.nodal(body, "displacement")[cells.nodes]
        slopes = np.einsum("cak,cai->cik", cells.gradients, displacement)
        if self._freezes:
            solid = snapshot.nodal(body, "solid_fraction")[cells.nodes].min(axis=1)
            slopes = _since_freezing(self._slopes_at_freezing, body, slopes, solid, snapshot.step)
        norms = np.linalg.norm(slopes, axis=(1, 2))
        if norms.size:
            worst = int(np.argmax(norms))
            own = (float(norms[worst]), cells.middles[worst])
        else:
            own = (0.0, np.zeros(snapshot.mesh.parent.geometry.dim))
        all_ranks: list[tuple[float, FloatArray]] = self._comm.allgather(own)
        return max(all_ranks, key=lambda found: found[0])

    def _largest(self, snapshot: Snapshot, body: str) -> float:
        """Return the largest displacement of the solid of a body on all ranks [m]."""
        displacement = snapshot.nodal(body, "displacement")
        if self._freezes:
            solid, step = snapshot.nodal(body, "solid_fraction"), snapshot.step
            displacement = _since_freezing(
                self._places_at_freezing, body, displacement, solid, step
            )
        own = float(np.linalg.norm(displacement, axis=1).max()) if len(displacement) else 0.0
        return float(self._comm.allreduce(own, MPI.MAX))

    def _of(self, mesh: CastingMesh, body: str) -> _Cells:
        if body not in self._cells:
            self._cells[body] = _cells_of(mesh.bodies[body], size_of(mesh, body))
        return self._cells[body]


def _since_freezing(
    at_freezing: dict[str, FloatArray],
    body: str,
    present: FloatArray,
    solid: FloatArray,
    step: int,
) -> FloatArray:
    """Return the change of values since they froze, zero where they have not."""
    # A run that is taken up again counts from there.
    first = present if step > 1 else np.zeros_like(present)
    kept = at_freezing.setdefault(body, first.copy())
    kept[solid < FULLY_SOLID] = present[solid < FULLY_SOLID]
    return present - kept


def _cells_of(body: BodyMesh, size: float) -> _Cells:
    topology = body.mesh.topology
    owned = topology.index_map(topology.dim).size_local
    nodes = body.nodes.dofmap.list[:owned]
    corners = body.points[nodes]
    return _Cells(nodes, midpoint_gradients(body.nodes, corners)[0], corners.mean(axis=1), size)
