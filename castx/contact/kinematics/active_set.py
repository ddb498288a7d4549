"""The primal-dual active set: which pairs are closed (Hintermüller, Ito, Kunisch 2002).

A closed pair that is pulled opens, an open pair that penetrates closes, all at once. Where that
leads back to a set that was there before it would cycle for ever; then one pair changes at a time,
until fewer pairs violate their state than ever before, from where on all change again (J. J. Júdice
and F. M. Pires, Computers and Operations Research 21 (1994)). It is the worst one, with those that
are as bad, and once a set has returned that way too the first one in an order of all pairs, which
ends at the solution of every problem that has just one (K. G. Murty, Linear Algebra and its
Applications 7 (1974)). If even then a set returns, as it may with friction, the pair chatters: it
is frozen for the rest of the step in the state in which it violates less.
"""

from __future__ import annotations

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray

ALIKE = 1e-3
"""Difference of violations, relative, below which pairs change together: which of two that mirror
each other is the worst one rounding decides, and the other one would follow by itself."""

PROVISIONAL = 2
"""Pass of a step up to which pairs that let go in an earlier one may be held anew: its heat is
another, and metal that had just frozen at a wall may be liquid in it. Metal that bears less in it
is not held anew: back at its wall it would lose as much heat as before, and let go once more."""

ROUNDED = 1e-12
"""Part of the largest force of a closed pair that is noise in the others."""

MOST_RESTARTS = 20
"""Times in a solve that cycle detection may restart."""


class Pivoting:
    """Choice of the pairs that change their state next, so that the active sets end.

    Attributes:
        frozen: pairs that chatter and do not change any more, shape (pairs,).
        cycles: whether a set has returned since `begin`.
        one_by_one: whether pairs change one at a time.

    Args:
        comm: communicator of the pairs.
        signatures: one number for each pair by which sets are distinguished, shape (pairs,).
    """

    def __init__(self, comm: MPI.Intracomm, signatures: FloatArray) -> None:
        self._comm, self._signatures = comm, signatures
        self.frozen: BoolArray = np.zeros(len(signatures), dtype=bool)
        self._left: FloatArray = np.zeros(len(signatures))
        self.restart(self.frozen)

    def begin(self, closed: BoolArray) -> None:
        """Begin a solve from a set of closed pairs."""
        self._left[:] = 0.0
        self.restart(closed)

    def restart(self, closed: BoolArray) -> None:
        """Forget all sets but the present one."""
        self._seen = {self._signature(closed)}
        self._fewest, self._in_order = np.inf, False
        self.cycles = self.one_by_one = False

    def at_once(self, violation: FloatArray) -> BoolArray:
        """Return a mask of the pairs to change without comparing sets: none once a set recurs.

        Args:
            violation: forces by which pairs violate their state [N], zero where they do not.
        """
        wrong = (violation > 0) & ~self.frozen & (not self.cycles)
        self._left[wrong] = np.inf
        return np.asarray(wrong)

    def next(self, closed: BoolArray, violation: FloatArray) -> BoolArray:
        """Return a mask of the pairs to change, and remember the resulting active set; collective.

        Args:
            closed: the present set of closed pairs.
            violation: forces by which pairs violate their state [N], zero where they do not.
        """
        wrong = self._choose(closed, violation)
        self._left = np.where(wrong, violation, self._left)
        self._seen.add(self._signature(closed ^ wrong))
        return wrong

    def _choose(self, closed: BoolArray, violation: FloatArray) -> BoolArray:
        wrong = (violation > 0) & ~self.frozen
        count = int(self._comm.allreduce(int(np.count_nonzero(wrong)), op=MPI.SUM))
        if count == 0:
            return wrong
        if self.one_by_one and count < self._fewest:
            self.one_by_one, self._seen = False, {self._signature(closed)}
        self._fewest = min(self._fewest, count)
        if not self.one_by_one:
            if self._signature(closed ^ wrong) not in self._seen:
                return wrong
            self.cycles = self.one_by_one = True
            self._in_order, self._seen = False, {self._signature(closed)}
        return self._single(closed, violation)

    def _single(self, closed: BoolArray, violation: FloatArray) -> BoolArray:
        """Return the pairs that change alone: the worst ones, the first in order, or none."""
        while True:
            wrong = (violation > 0) & ~self.frozen
            if self._in_order:
                chosen = self._least(np.where(wrong, self._signatures, np.inf))
            else:
                chosen = self._worst(np.where(wrong, violation, 0.0))
            if not self._any(chosen) or self._signature(closed ^ chosen) not in self._seen:
                return chosen
            if not self._in_order:
                self._in_order, self._seen = True, {self._signature(closed)}
                continue
            self.frozen = self.frozen | chosen
            goes_back = chosen & (violation > self._left)
            if self._any(goes_back):
                return goes_back

    def _worst(self, violation: FloatArray) -> BoolArray:
        """Return the pair with the largest violation on all ranks, and those as bad."""
        largest = self._comm.allreduce(float(violation.max(initial=0.0)), op=MPI.MAX)
        return np.asarray((violation > 0.0) & (violation >= (1.0 - ALIKE) * largest))

    def _least(self, keys: FloatArray) -> BoolArray:
        """Return the pair with the least key on all ranks, none where no key is finite."""
        local = float(keys.min(initial=np.inf))
        least, rank = self._comm.allreduce((local, self._comm.rank), op=MPI.MINLOC)
        chosen = np.zeros(len(keys), dtype=bool)
        if rank == self._comm.rank and np.isfinite(least):
            chosen[int(np.argmin(keys))] = True
        return chosen

    def _any(self, pairs: BoolArray) -> bool:
        return bool(self._comm.allreduce(bool(pairs.any()), op=MPI.LOR))

    def _signature(self, closed: BoolArray) -> tuple[int, int]:
        chosen = np.round(self._signatures[closed] * 2**40).astype(np.int64)
        both = np.array([len(chosen), int(chosen.sum())], dtype=np.int64)
        total = self._comm.allreduce(both, op=MPI.SUM)
        return int(total[0]), int(total[1])


class ActiveSet:
    """The closed pairs of all interfaces on this rank.

    They follow from g ≥ 0, p_c ≥ 0, g p_c = 0 (Chiumenti, section 7.1, Kuhn–Tucker conditions).

    Attributes:
        closed: closed pairs, shape (pairs,).
        held: closed pairs that may be pulled, shape (pairs,).
        changes: pairs that have changed since `begin`, on all ranks.

    Args:
        comm: communicator of the pairs.
        initial_gaps: gaps without displacement [m], shape (pairs,).
        free: pairs that carry a constraint, shape (pairs,).
        signatures: one number for each pair by which sets are distinguished, shape (pairs,).
    """

    def __init__(
        self, comm: MPI.Intracomm, initial_gaps: FloatArray, free: BoolArray, signatures: FloatArray
    ) -> None:
        self._comm, self._free = comm, free
        self._pivoting = Pivoting(comm, signatures)
        self.closed: BoolArray = free & (initial_gaps <= 0)
        self._committed = self.closed.copy()
        self._pulls: FloatArray = np.zeros(len(free))
        self._let_go: BoolArray = np.zeros(len(free), dtype=bool)
        self._holds = 0
        self._released: BoolArray = np.zeros(len(free), dtype=bool)
        self.begin()

    @property
    def frozen(self) -> BoolArray:
        """Pairs that do not change until the end of the step, shape (pairs,)."""
        return self._pivoting.frozen

    @property
    def cycles(self) -> bool:
        """Whether a set has returned since `begin`."""
        return self._pivoting.cycles

    @property
    def one_by_one(self) -> bool:
        """Whether pairs change one at a time."""
        return self._pivoting.one_by_one

    def begin(self) -> None:
        """Begin a solve from the present set."""
        self._pivoting.begin(self.closed)
        self.changes = self._restarts = 0

    @property
    def held(self) -> BoolArray:
        """Pairs that may be pulled while they are closed, shape (pairs,)."""
        return np.asarray(self._pulls > 0.0)

    def hold(self, pulls: FloatArray, closing: BoolArray) -> None:
        """Let closed pairs be pulled until the next call.

        A pair that lets go in the first pass of a step is held anew by the second one if its metal
        is liquid by then; later, pairs let go once. If all were held anew, the skin would let go
        ring by ring once more.

        Args:
            pulls: largest pulls of the pairs [N], infinite at liquid, shape (pairs,).
            closing: pairs that close whatever their gap, shape (pairs,).
        """
        self._holds += 1
        if self._holds <= PROVISIONAL:
            anew = self._committed & self._let_go & np.isinf(pulls)
            self.closed = self.closed | anew
            self._let_go &= ~anew
        may = (self._committed | closing) & ~self._let_go
        self._pulls = np.where(may, pulls, 0.0)
        self.closed = self.closed | (closing & ~self._let_go)

    def restart_cycle_detection(self) -> None:
        """Let known sets return after the friction state has changed, at most 20 times a solve."""
        if self._restarts < MOST_RESTARTS:
            self._restarts += 1
            self._pivoting.restart(self.closed)

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
            wrong = self._pivoting.next(self.closed, violation)
        else:
            wrong = self._pivoting.at_once(violation)
        changed = self._count(wrong)
        self._let_go |= wrong & self.closed
        self._pulls[self._let_go] = 0.0
        self.closed = self.closed ^ wrong
        self.changes += changed
        return changed > 0

    def _violation(self, forces: FloatArray, threshold: float) -> FloatArray:
        """Return the forces by which pairs violate their state [N], zero where they do not."""
        violation = np.where(self.closed, -forces - self._pulls, forces)
        violation[~self._free | (violation <= self.noise(forces, threshold))] = 0.0
        return violation

    def noise(self, forces: FloatArray, threshold: float) -> float:
        """Return the force below which no pair changes its state [N]; collective.

        Args:
            forces: that closed pairs carry and open ones would [N], shape (pairs,).
            threshold: force that is noise in any case [N].
        """
        carried = float(np.abs(forces[self.closed]).max(initial=0.0))
        largest = self._comm.allreduce(carried, op=MPI.MAX)
        return float(max(ROUNDED * largest, threshold))

    def _count(self, pairs: BoolArray) -> int:
        return int(self._comm.allreduce(int(np.count_nonzero(pairs)), op=MPI.SUM))

    def violates(self, forces: FloatArray, threshold: float) -> bool:
        """Return whether any pair, frozen or not, pulls or penetrates by more than noise.

        Args:
            forces: that closed pairs carry and open ones would [N], shape (pairs,).
            threshold: force that is noise [N].
        """
        return self.any(self._violation(forces, threshold) > 0)

    def largest_pull(self, forces: FloatArray, with_frozen: bool = False) -> float:
        """Return the largest force by which a closed pair is pulled beyond its limit; collective.

        Args:
            forces: that closed pairs carry [N], compressive positive, shape (pairs,).
            with_frozen: whether pairs count that do not change any more.

        Returns:
            It [N], zero where none is pulled.
        """
        pulled = self.closed & self._free
        pulls = -(forces + self._pulls)[pulled if with_frozen else pulled & ~self.frozen]
        return float(self._comm.allreduce(float(pulls.max(initial=0.0)), op=MPI.MAX))

    def release(self, forces: FloatArray, threshold: float) -> BoolArray:
        """Open closed pairs without force, each of them once in a step; return which.

        Args:
            forces: that closed pairs carry [N], compressive positive, shape (pairs,).
            threshold: force that is none [N].
        """
        may = self.closed & self._free & ~self.frozen & ~self.held & ~self._released
        weak = may & (forces <= threshold)
        self._released = self._released | weak
        self.closed = self.closed & ~weak
        self._pivoting.restart(self.closed)
        return weak

    def close(self, pairs: BoolArray) -> None:
        """Close pairs that need not have been released."""
        self.closed = self.closed | pairs
        self._pivoting.restart(self.closed)

    def any(self, pairs: BoolArray) -> bool:
        """Return whether one of some pairs is marked, on any rank."""
        return bool(self._comm.allreduce(bool(pairs.any()), op=MPI.LOR))

    def frozen_pairs(self) -> int:
        """Return the number of frozen pairs of all ranks."""
        return self._count(self.frozen)

    def commit(self) -> None:
        """Accept the present active set."""
        self._committed = self.closed.copy()
        self._begin_step()

    def _begin_step(self) -> None:
        self.frozen[:] = False
        self._released[:] = False
        self._let_go[:] = False
        self._holds = 0

    def restore(self, closed: BoolArray) -> None:
        """Restore the active set of the last accepted step."""
        self._committed = closed.copy()
        self.rewind()

    @property
    def committed(self) -> BoolArray:
        """The closed pairs of the last accepted step, shape (pairs,)."""
        return self._committed

    def rewind(self) -> None:
        """Return to the set of the last accepted step."""
        self.closed = self._committed.copy()
        self._pulls[:] = 0.0
        self._begin_step()
