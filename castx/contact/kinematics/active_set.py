"""The primal-dual active set: which pairs are closed (Hintermüller, Ito, Kunisch 2002).

A closed pair that is pulled opens, an open pair that penetrates closes. A set that returns would
cycle for ever, as happens with pairs without pressure on a soft liquid; from then on only the worst
pair changes. If even then a set returns, the pair chatters: it is frozen for the rest of the step
in the state in which it violates less.
"""

from __future__ import annotations

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray

MOST_RESTARTS = 20
"""Times in a solve that cycle detection may restart."""


class ActiveSet:
    """The closed pairs of all interfaces on this rank.

    They follow from g ≥ 0, p_c ≥ 0, g p_c = 0 (Chiumenti, section 7.1, Kuhn–Tucker conditions).

    Attributes:
        closed: closed pairs, shape (pairs,).
        frozen: pairs that do not change until the end of the step, shape (pairs,).
        changes: pairs that have changed since `begin`, on all ranks.
        cycles: whether a set has returned since `begin`.

    Args:
        comm: communicator of the pairs.
        initial_gaps: gaps without displacement [m], shape (pairs,).
        free: pairs that carry a constraint, shape (pairs,).
        signatures: one number for each pair by which sets are distinguished, shape (pairs,).
    """

    def __init__(
        self, comm: MPI.Intracomm, initial_gaps: FloatArray, free: BoolArray, signatures: FloatArray
    ) -> None:
        self._comm, self._free, self._signatures = comm, free, signatures
        self.closed: BoolArray = free & (initial_gaps <= 0)
        self._committed = self.closed.copy()
        self.frozen: BoolArray = np.zeros(len(free), dtype=bool)
        self.begin()

    def begin(self) -> None:
        """Begin a solve from the present set."""
        self._seen = {self._signature(self.closed)}
        self._left: FloatArray = np.zeros(len(self.closed))
        self.changes = self._restarts = 0
        self.cycles = False

    def restart_cycle_detection(self) -> None:
        """Let known sets return after the friction state has changed, at most 20 times a solve."""
        if self._restarts < MOST_RESTARTS:
            self._restarts += 1
            self._seen = {self._signature(self.closed)}
            self.cycles = False

    def update(self, forces: FloatArray, threshold: float = 0.0) -> bool:
        """Change the pairs that violate their state; return whether any did, on any rank.

        Args:
            forces: that closed pairs carry and open ones would [N], compressive positive, shape
                (pairs,).
            threshold: force that is noise [N].
        """
        carried = float(np.abs(forces[self.closed]).max(initial=0.0))
        largest = self._comm.allreduce(carried, op=MPI.MAX)
        violation = np.where(self.closed, -forces, forces)
        violation[~self._free | (violation <= max(1e-12 * largest, threshold))] = 0.0
        wrong = self._to_change(violation)
        changed = int(self._comm.allreduce(int(np.count_nonzero(wrong)), op=MPI.SUM))
        self._left = np.where(wrong, violation, self._left)
        self.closed = self.closed ^ wrong
        self._seen.add(self._signature(self.closed))
        self.changes += changed
        return changed > 0

    def _to_change(self, violation: FloatArray) -> BoolArray:
        wrong = (violation > 0) & ~self.frozen
        if not self.cycles and not self._is_known(wrong):
            return wrong
        self.cycles = True
        while True:
            worst = self._worst(np.where(self.frozen, 0.0, violation))
            if not self._is_known(worst):
                return worst
            self.frozen = self.frozen | worst
            goes_back = worst & (violation > self._left)
            if self.any(goes_back):
                return goes_back

    def _is_known(self, wrong: BoolArray) -> bool:
        """Return whether a change leads to a known set."""
        return self.any(wrong) and self._signature(self.closed ^ wrong) in self._seen

    def any(self, pairs: BoolArray) -> bool:
        """Return whether one of some pairs is marked, on any rank."""
        return bool(self._comm.allreduce(bool(pairs.any()), op=MPI.LOR))

    def _worst(self, violation: FloatArray) -> BoolArray:
        local = float(violation.max(initial=0.0))
        worst, rank = self._comm.allreduce((local, self._comm.rank), op=MPI.MAXLOC)
        chosen = np.zeros(len(violation), dtype=bool)
        if rank == self._comm.rank and worst > 0:
            chosen[int(np.argmax(violation))] = True
        return chosen

    def _signature(self, closed: BoolArray) -> tuple[int, int]:
        chosen = np.round(self._signatures[closed] * 2**40).astype(np.int64)
        both = np.array([len(chosen), int(chosen.sum())], dtype=np.int64)
        total = self._comm.allreduce(both, op=MPI.SUM)
        return int(total[0]), int(total[1])

    def frozen_pairs(self) -> int:
        """Return the number of frozen pairs of all ranks."""
        return int(self._comm.allreduce(int(np.count_nonzero(self.frozen)), op=MPI.SUM))

    def commit(self) -> None:
        """Accept the present set as that of the last step."""
        self._committed = self.closed.copy()
        self.frozen[:] = False

    def restore(self, closed: BoolArray) -> None:
        """Take back a set of closed pairs as that of the last accepted step."""
        self._committed = closed.copy()
        self.rewind()

    @property
    def committed(self) -> BoolArray:
        """The closed pairs of the last accepted step, shape (pairs,)."""
        return self._committed

    def rewind(self) -> None:
        """Return to the set of the last accepted step."""
        self.closed = self._committed.copy()
        self.frozen[:] = False
