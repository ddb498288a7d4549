"""The primal-dual active set: which pairs are closed (Hintermüller, Ito, Kunisch 2002).

A closed pair that is pulled opens, an open pair that penetrates closes, all at once. Where that
leads back to a set that was there before it would cycle for ever; then one pair changes at a time,
until fewer pairs violate their state than ever before, from where on all change again (J. J. Júdice
and F. M. Pires, Computers and Operations Research 21 (1994)). It is the worst one, and once a set
has returned that way too the first one in an order of all pairs, which ends at the solution of
every problem that has just one (K. G. Murty, Linear Algebra and its Applications 7 (1974)). If even
then a set returns, as it may with friction, the pair chatters: it is frozen for the rest of the
step in the state in which it violates less.
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
        held: pairs that stay closed whatever the sign of their force, shape (pairs,).
        changes: pairs that have changed since `begin`, on all ranks.
        cycles: whether a set has returned since `begin`.
        one_by_one: whether pairs change one at a time.

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
        self.held: BoolArray = np.zeros(len(free), dtype=bool)
        self.begin()

    def begin(self) -> None:
        """Begin a solve from the present set."""
        self._seen = {self._signature(self.closed)}
        self._left: FloatArray = np.zeros(len(self.closed))
        self._known_singles: set[tuple[int, int]] = set()
        self._fewest, self._in_order = np.inf, False
        self.changes = self._restarts = 0
        self.cycles = self.one_by_one = False

    def hold(self, held: BoolArray) -> None:
        """Close pairs and keep them closed until the next call; judge the others as usual.

        Args:
            held: pairs that carry a constraint, shape (pairs,).
        """
        self.held = held.copy()
        self.closed = self.closed | held

    def restart_cycle_detection(self) -> None:
        """Let known sets return after the friction state has changed, at most 20 times a solve."""
        if self._restarts < MOST_RESTARTS:
            self._restarts += 1
            self._seen = {self._signature(self.closed)}
            self._fewest, self.cycles, self.one_by_one = np.inf, False, False

    def update(self, forces: FloatArray, threshold: float = 0.0, settled: bool = True) -> bool:
        """Change the pairs that violate their state; return whether any did, on any rank.

        Args:
            forces: that closed pairs carry and open ones would [N], compressive positive, shape
                (pairs,).
            threshold: force that is noise [N].
            settled: whether the forces are those of the present set. Otherwise a set that returns
                is no cycle, since the problem is another one by now; once one has returned, nothing
                changes before they are.
        """
        violation = self._violation(forces, threshold)
        if settled:
            wrong = self._to_change(violation)
            self._left = np.where(wrong, violation, self._left)
        else:
            wrong = (violation > 0) & ~self.frozen & (not self.cycles)
            self._left[wrong] = np.inf
        changed = self._count(wrong)
        self.closed = self.closed ^ wrong
        if settled:
            self._seen.add(self._signature(self.closed))
        self.changes += changed
        return changed > 0

    def _violation(self, forces: FloatArray, threshold: float) -> FloatArray:
        """Return the forces by which pairs violate their state [N], zero where they do not."""
        carried = float(np.abs(forces[self.closed]).max(initial=0.0))
        largest = self._comm.allreduce(carried, op=MPI.MAX)
        violation = np.where(self.closed, -forces, forces)
        noise = violation <= max(1e-12 * largest, threshold)
        violation[~self._free | self.held | noise] = 0.0
        return violation

    def _to_change(self, violation: FloatArray) -> BoolArray:
        wrong = (violation > 0) & ~self.frozen
        count = self._count(wrong)
        if self.one_by_one and count < self._fewest:
            self.one_by_one = False
            self._seen = {self._signature(self.closed)}
        self._fewest = min(self._fewest, count)
        if not self.one_by_one and not self._is_known(wrong, self._seen):
            return wrong
        if not self.one_by_one:
            self.cycles = self.one_by_one = True
            self._in_order, self._known_singles = False, {self._signature(self.closed)}
        while True:
            choose = self._first if self._in_order else self._worst
            chosen = choose(np.where(self.frozen, 0.0, violation))
            if not self._is_known(chosen, self._known_singles):
                self._known_singles.add(self._signature(self.closed ^ chosen))
                return chosen
            if not self._in_order:
                self._in_order, self._known_singles = True, {self._signature(self.closed)}
                continue
            self.frozen = self.frozen | chosen
            goes_back = chosen & (violation > self._left)
            if self.any(goes_back):
                return goes_back

    def _is_known(self, wrong: BoolArray, sets: set[tuple[int, int]]) -> bool:
        """Return whether a change leads to one of some sets."""
        return self.any(wrong) and self._signature(self.closed ^ wrong) in sets

    def _count(self, pairs: BoolArray) -> int:
        return int(self._comm.allreduce(int(np.count_nonzero(pairs)), op=MPI.SUM))

    def violates_frozen(self, forces: FloatArray, threshold: float) -> bool:
        """Return whether a frozen pair pulls or penetrates by more than noise, on any rank.

        Args:
            forces: that closed pairs carry and open ones would [N], shape (pairs,).
            threshold: force that is noise [N].
        """
        return self.any(self.frozen & (self._violation(forces, threshold) > 0))

    def largest_pull(self, forces: FloatArray) -> float:
        """Return the largest force by which a closed pair is pulled [N], on all ranks."""
        pulls = -forces[self.closed & self._free & ~self.frozen & ~self.held]
        return float(self._comm.allreduce(float(pulls.max(initial=0.0)), op=MPI.MAX))

    def any(self, pairs: BoolArray) -> bool:
        """Return whether one of some pairs is marked, on any rank."""
        return bool(self._comm.allreduce(bool(pairs.any()), op=MPI.LOR))

    def _worst(self, violation: FloatArray) -> BoolArray:
        """Return the pair that violates its state most, none where none does."""
        return self._extreme(violation, -violation)

    def _first(self, violation: FloatArray) -> BoolArray:
        """Return the first pair that violates its state, in an order of all pairs."""
        return self._extreme(violation, self._signatures)

    def _extreme(self, violation: FloatArray, keys: FloatArray) -> BoolArray:
        """Return the pair with the least key among those that violate their state."""
        keys = np.where(violation > 0, keys, np.inf)
        local = float(keys.min(initial=np.inf))
        least, rank = self._comm.allreduce((local, self._comm.rank), op=MPI.MINLOC)
        chosen = np.zeros(len(keys), dtype=bool)
        if rank == self._comm.rank and np.isfinite(least):
            chosen[int(np.argmin(keys))] = True
        return chosen

    def _signature(self, closed: BoolArray) -> tuple[int, int]:
        chosen = np.round(self._signatures[closed] * 2**40).astype(np.int64)
        both = np.array([len(chosen), int(chosen.sum())], dtype=np.int64)
        total = self._comm.allreduce(both, op=MPI.SUM)
        return int(total[0]), int(total[1])

    def frozen_pairs(self) -> int:
        """Return the number of frozen pairs of all ranks."""
        return self._count(self.frozen)

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
        self.frozen[:] = self.held[:] = False
