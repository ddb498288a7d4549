"""Force to draw the bodies of each interface apart, μ Σ p S, over time and at the ends of stages.

What Coulomb's friction bears at most if every pair slides in the direction of drawing; draught and
adhesion are left out, and the change of the pressures while the bodies move.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.case.case import Case
from castx.case.stages import Schedule
from castx.foundry.stress.first_opening import PairedState
from castx.stateful import Arrays, Saved

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh
    from castx.domain.pairs.node_pairs import NodePairs


class EjectionForces:
    """Forces of all interfaces, and those at the end of each stage, in cycles of the last one.

    Args:
        comm: the ranks.
        areas: of the owned pairs by interface, (pairs,) [m²].
        friction: coefficient μ.
        stages: number of stages, the start included.
    """

    def __init__(
        self, comm: MPI.Intracomm, areas: Mapping[str, FloatArray], friction: float, stages: int
    ) -> None:
        self._comm, self._areas, self._friction = comm, areas, friction
        self._forces: FloatArray = np.zeros(len(areas))
        # One row for each stage: cycle, time, forces; not a number before its end.
        self._ends: FloatArray = np.full((stages, 2 + len(areas)), np.nan)

    def update(self, state: PairedState) -> None:
        """Take over the state after an accepted step; collective."""
        if not self._areas:
            return
        normal = np.zeros(len(self._areas))
        for place, (name, areas) in enumerate(self._areas.items()):
            if name in state.pairs:
                normal[place] = areas @ np.maximum(state.paired(name, "contact_pressure"), 0.0)
        self._comm.Allreduce(MPI.IN_PLACE, normal, op=MPI.SUM)
        self._forces = self._friction * normal
        end = self._ends[state.process.stage]
        end[:2], end[2:] = (state.process.cycle, state.time), self._forces

    def field(self, body: str, name: str) -> FloatArray | None:
        """Return nothing: there is one number for each interface."""
        return None

    def totals(self) -> dict[str, float]:
        """Return the forces by the name of their column [N]."""
        names = (f"{name}.ejection_force" for name in self._areas)
        return dict(zip(names, (float(force) for force in self._forces), strict=True))

    def described(self) -> list[dict[str, Any]]:
        """Return the forces at the ends of the stages so far for run.json [N]."""
        found = []
        for stage in range(len(self._ends)):
            cycle, time = (float(self._ends[stage, column]) for column in (0, 1))
            if self._areas and np.isfinite(time):
                forces = {
                    name: float(self._ends[stage, 2 + k]) for k, name in enumerate(self._areas)
                }
                found.append({"stage": stage, "cycle": int(cycle), "time": time, "forces": forces})
        return found

    def saved(self) -> dict[str, Saved]:
        """Return the forces at the ends of the stages so far."""
        return {"ends": Saved(self._ends)} if self._areas else {}

    def restore(self, arrays: Arrays) -> None:
        """Go on with the ends of an earlier part of the run, unless it had other interfaces."""
        if arrays["ends"].shape == self._ends.shape:
            self._ends = np.array(arrays["ends"])


def ejection_forces_of(
    case: Case, mesh: CastingMesh, pairs: Mapping[str, NodePairs]
) -> EjectionForces:
    """Return the forces of the interfaces of a case, of none if its friction is not given."""
    friction = case.foundry.ejection_friction
    known = friction is not None and case.coupling.scheme != "thermal"
    areas = {name: found.areas for name, found in pairs.items()} if known else {}
    stages = Schedule(case.stages, case.time.end).stages
    return EjectionForces(mesh.comm, areas, friction or 0.0, stages)
