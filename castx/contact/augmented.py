"""Augmented Lagrangian multipliers (Chiumenti, section 7.2): λ ← ⟨λ - ε g⟩ between iterations."""

from __future__ import annotations

from collections.abc import Mapping

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray


class AugmentedMultipliers:
    """Pressures that take over what the penalty carries, so that the penetration shrinks.

    λ ← ⟨λ - ε g⟩ (Chiumenti, section 7.2, with tension left out).

    Args:
        comm: communicator of the pairs.
        rows: number of rows of all interfaces on this rank.
        every_iteration: whether each Newton iteration is followed by an update; else only those
            that balance are, in a loop round Newton's method.
        most: updates in one solve; after the last one the pressures stay.
    """

    def __init__(
        self, comm: MPI.Intracomm, rows: int, every_iteration: bool, most: int
    ) -> None:
        self._comm, self._every_iteration, self._most = comm, every_iteration, most
        self.pressures: FloatArray = np.zeros(rows)
        self._committed: FloatArray = self.pressures.copy()
        self.updates = 0

    def begin(self) -> None:
        """Start a new solve from the present pressures."""
        self.updates = 0

    def augment(self, pressures: FloatArray, balanced: bool) -> bool:
        """Take over better pressures [Pa], no tension; return whether they changed, on any rank."""
        if self.updates >= self._most or not (balanced or self._every_iteration):
            return False
        better: FloatArray = np.maximum(pressures, 0.0)
        changed = self._comm.allreduce(bool(np.any(better != self.pressures)), op=MPI.LOR)
        self.pressures = np.asarray(better)
        self.updates += int(changed)
        return bool(changed)

    def commit(self) -> None:
        """Make the present pressures those from which the next step starts."""
        self._committed = self.pressures.copy()

    def saved(self) -> dict[str, FloatArray]:
        """Return the committed pressures [Pa]."""
        return {"pressures": self._committed}

    def restore(self, arrays: Mapping[str, FloatArray]) -> None:
        """Take back committed pressures [Pa]."""
        self._committed = arrays["pressures"].copy()
        self.rewind()

    def rewind(self) -> None:
        """Return to the committed pressures."""
        self.pressures = self._committed.copy()
