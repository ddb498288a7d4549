"""The primal-dual active set: which pairs are closed (Hintermüller, Ito, Kunisch 2002).

A closed pair that is pulled opens, an open pair that penetrates closes. A set that comes back
would go round for ever, as happens with pairs of no pressure on a soft liquid; from then on only
the worst pair changes.
"""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]


class ActiveSet:
    """The closed pairs of all interfaces on this rank.

    Args:
        comm: communicator of the pairs.
        initial_gaps: gaps without displacement [m], shape (pairs,).
        free: pairs that carry a constraint, shape (pairs,).
        keys: one number for each pair by which sets are told apart, shape (pairs,).
    """

    def __init__(
        self, comm: MPI.Intracomm, initial_gaps: FloatArray, free: BoolArray, keys: FloatArray
    ) -> None:
        self._comm, self._free, self._keys = comm, free, keys
        self.closed: BoolArray = free & (initial_gaps <= 0)
        self._committed = self.closed.copy()
        self.begin()

    def begin(self) -> None:
        """Forget the sets seen: a new problem starts from the present one."""
        self._seen = {self._signature(self.closed)}
        self.changes = 0
        self.cycles = False

    def update(
        self, gaps: FloatArray, forces: FloatArray, stiffness: float, threshold: float = 0.0
    ) -> bool:
        """Change the pairs that violate their state; return whether any did, on any rank.

        Args:
            gaps: present gaps [m], shape (pairs,).
            forces: contact forces that closed pairs carry [N], shape (pairs,).
            stiffness: force per length by which penetration and pull are compared [N/m].
            threshold: pull or penetration times stiffness that is noise [N].
        """
        violation = np.where(self.closed, -forces, -stiffness * gaps)
        violation[~self._free] = 0.0
        largest = self._comm.allreduce(float(np.abs(forces).max(initial=0.0)), op=MPI.MAX)
        wrong = violation > max(1e-12 * largest, threshold)
        if self.cycles or self._repeats(wrong):
            self.cycles = True
            wrong &= self._is_worst(violation)
        changed = int(self._comm.allreduce(int(np.count_nonzero(wrong)), op=MPI.SUM))
        self.closed = self.closed ^ wrong
        self._seen.add(self._signature(self.closed))
        self.changes += changed
        return changed > 0

    def _repeats(self, wrong: BoolArray) -> bool:
        moved = self._comm.allreduce(bool(wrong.any()), op=MPI.LOR)
        return moved and self._signature(self.closed ^ wrong) in self._seen

    def _is_worst(self, violation: FloatArray) -> BoolArray:
        local = float(violation.max(initial=-np.inf))
        worst, rank = self._comm.allreduce((local, self._comm.rank), op=MPI.MAXLOC)
        chosen = np.zeros(len(violation), dtype=bool)
        if rank == self._comm.rank and worst > 0:
            chosen[int(np.argmax(violation))] = True
        return chosen

    def _signature(self, closed: BoolArray) -> tuple[int, int]:
        keys = np.round(self._keys[closed] * 2**40).astype(np.int64)
        both = np.array([len(keys), int(keys.sum())], dtype=np.int64)
        total = self._comm.allreduce(both, op=MPI.SUM)
        return int(total[0]), int(total[1])

    def commit(self) -> None:
        """Make the present set the one to which `rewind` returns."""
        self._committed = self.closed.copy()

    def rewind(self) -> None:
        """Return to the set of the last accepted step."""
        self.closed = self._committed.copy()
