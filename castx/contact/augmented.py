"""Augmented Lagrangian multipliers (Chiumenti, section 7.2): λ ← ⟨λ - ε g⟩ between iterations."""

from __future__ import annotations

from collections.abc import Mapping

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.kinematics.gaps import Gaps


class AugmentedMultipliers:
    """Augmented Lagrange multipliers: pressures of the penalty, added up to reduce penetration.

    λ ← ⟨λ - ε g⟩ (Chiumenti, section 7.2, with tension left out).

    Attributes:
        pressures: λ [Pa], shape (rows,).
        updates: how often they have changed since `begin`.
        may_pull: pairs whose pressure may be negative, shape (rows,).

    Args:
        comm: communicator of the pairs.
        gaps: the pairs of all interfaces.
        every_iteration: whether each Newton iteration is followed by an update; else only those
            that balance are, in a loop round Newton's method.
        most: updates in one solve; after the last one the pressures stay.
    """

    def __init__(
        self, comm: MPI.Intracomm, gaps: Gaps, every_iteration: bool, most: int
    ) -> None:
        self._comm, self._gaps = comm, gaps
        self._every_iteration, self._most = every_iteration, most
        self._work = gaps.matrix.createVecLeft()
        self.pressures: FloatArray = np.zeros(len(gaps.local))
        self._committed: FloatArray = self.pressures.copy()
        self.may_pull: BoolArray = np.zeros(len(gaps.local), dtype=bool)
        self.updates = 0

    def forces(self) -> FloatArray:
        """Return λ S [N], zero where no pair is free."""
        return np.where(self._gaps.free, self.pressures * self._gaps.areas, 0.0)

    def begin(self) -> None:
        """Begin a solve from the present pressures."""
        self.updates = 0

    def augment(
        self, forces: FloatArray, closed: BoolArray, balanced: bool, enough: float
    ) -> bool:
        """Take over the pressures of closed pairs; return whether any changed, on any rank.

        Args:
            forces: trial forces [N].
            closed: the present set of closed pairs.
            balanced: whether the rows balance with the present pressures.
            enough: change of the forces that is not worth another solution [N].
        """
        areas = self._gaps.areas
        pressures = np.divide(forces, areas, out=np.zeros_like(forces), where=areas > 0)
        pressures[~closed] = 0.0
        self._work.array[:] = areas * (pressures - self.pressures)
        if balanced and self._work.norm() <= enough:
            return False
        if self.updates >= self._most or not (balanced or self._every_iteration):
            return False
        better = np.where(self.may_pull, pressures, np.maximum(pressures, 0.0))
        changed = self._comm.allreduce(bool(np.any(better != self.pressures)), op=MPI.LOR)
        self.pressures = np.asarray(better)
        self.updates += int(changed)
        return bool(changed)

    def commit(self, x: PETSc.Vec) -> None:
        """Accept the present pressures as the start of the next step."""
        self._committed = self.pressures.copy()

    def rewind(self, x: PETSc.Vec) -> None:
        """Return to the accepted pressures."""
        self.pressures = self._committed.copy()

    def saved(self) -> dict[str, FloatArray]:
        """Return the accepted pressures [Pa]."""
        return {"pressures": self._committed}

    def restore(self, arrays: Mapping[str, FloatArray]) -> None:
        """Restore accepted pressures [Pa]."""
        self._committed = arrays["pressures"].copy()
        self.pressures = self._committed.copy()

    def destroy(self) -> None:
        """Free the vector."""
        self._work.destroy()
