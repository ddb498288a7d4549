"""Changes of the pairs between Newton iterations: closing, slipping, better multipliers."""

from __future__ import annotations

from dataclasses import replace

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.equilibrium.forces import MomentumBalance
from castx.equilibrium.supports.first_contact import OVERLAP, FirstContact
from castx.profiling import RunPart, booked_as

NOISE_SHARE, NOISE_FACTOR = 0.1, 100.0
"""Forces that are too small to open or close a pair: at most a part of what balances, and no more
than a multiple of the residual, so that exact solutions see the weight of a body beside far larger
thermal forces."""

SETTLED = 1e-3
"""Residual beside the forces in a body from which on pairs may begin to slip or to stick, and those
with friction may open."""

CERTAIN, QUITE_CERTAIN = 0.5, 1e-3
"""Residual beside the largest pull of a pair from which on pairs may open, and where they change
one at a time. With 0.1 the bracket takes 324 iterations for 302 to 14 s, with 1 it takes 297, and
gaps are the same to 0.3 %."""

MOST_FORETOLD = 3
"""Openings of a pair in a solve after which it waits for forces that have settled."""


class PairChanges:
    """Changes the state of pairs and supports at an iterate.

    As long as what flows is not in equilibrium, closed pairs open by the forces that the last
    linear system foretold (semismooth Newton; Hintermüller, Ito and Kunisch 2002): those balance,
    where the forces of the iterate hold what its iteration left undone. So one iteration serves
    both the law and the set, instead of several for each ring of pairs that a skin leaves. The
    first that liquid holds let go by forces that have settled: those before know nothing of the
    flow by which metal that has just frozen yields to them, and what has let go stays open. From
    then on the skin peels off, ring by ring, and of the rings behind the forces are foretold.

    Args:
        balance: the nonlinear problem.

    Attributes:
        foretold: forces by which closed pairs open [N], shape (pairs,); None: those they have.
        has_settled: whether pairs have been judged by forces that had settled since `begin`.
    """

    def __init__(self, balance: MomentumBalance) -> None:
        self._balance = balance
        self._first_contact = FirstContact(balance.contact, balance.assembly.unknowns)
        self.foretold: FloatArray | None = None
        self.has_settled = False
        self._openings: IntArray = np.zeros(len(balance.trial_forces), dtype=np.int32)

    def begin(self) -> None:
        """Begin a solve."""
        self.foretold, self.has_settled = None, False
        self._openings[:] = 0

    def foretell(self, x: PETSc.Vec, y: PETSc.Vec, rows: FloatArray) -> None:
        """Keep the forces that closed pairs carry in the linear system after a step to x − y.

        Soft pairs, and those with friction, open by forces of their own, and where bodies yield
        without regard to a rate a linear system foretells little; there pairs would chatter.

        Args:
            x: the iterate, evaluated last.
            y: the step, before a line search shortens it.
            rows: of the linear system behind it, `MomentumBalance.foretold_rows`.
        """
        balance, pairs = self._balance, self._balance.contact.normal
        if pairs.follows_set or balance.contact.has_friction:
            return
        if not balance.assembly.flows_by_rate:
            return
        end = x.duplicate()
        end.waxpy(-1.0, y, x)
        self.foretold = pairs.trial_forces(replace(balance.present(end), rows=rows))
        end.destroy()

    @booked_as(RunPart.CONTACT)
    def update_pairs(self, x: PETSc.Vec, f: PETSc.Vec) -> bool:
        """Close and open pairs and gates at the present iterate.

        Where friction changes its state, normal forces follow it first.

        Args:
            x: the iterate.
            f: its residual, filled anew if it has changed.

        Returns:
            Whether a pair, a gate or a pore has changed, on any rank. A pore that opens is far from
            its pressure, of which the balance of forces notices little.
        """
        balance, active, limits = self._balance, self._balance.active, self._balance.convergence
        improved = balance.assembly.improve_pressures()
        if improved or not balance.is_evaluated_at(x):
            balance.residual(x, f)
        norm = f.norm()
        noise = max(min(NOISE_SHARE * limits.smallest, NOISE_FACTOR * norm), limits.rounding)
        slides = self._is_small(f)
        if balance.contact.update_friction(balance.present(x), balance.trial_forces, noise, slides):
            changed = True
            active.restart_cycle_detection()
        else:
            linear = balance.is_linear and not improved
            felt, before = balance.felt(balance.trial_forces), active.closed
            pull = 0.0 if linear else active.largest_pull(felt)
            settled = linear or self._is_settled(f, pull, slides)
            self.has_settled |= settled
            forces = felt if settled else self._unsettled(felt)
            changed = active.update(forces, noise, settled)
            self._openings += before & ~active.closed
            balance.contact.hold(active.held)
        gripped = balance.supports.change(active.closed, not changed)
        if not changed and not gripped:
            released = limits.is_met(f) and self._release_bodies(x, f)
            return released or balance.assembly.pores_changed
        balance.sum_up_again(x, f)
        return True

    def _is_small(self, f: PETSc.Vec) -> bool:
        """Return whether the residual is small beside the forces in a body."""
        limits = self._balance.convergence
        return bool(f.norm() <= SETTLED * max(limits.weakest, limits.smallest))

    def _release_bodies(self, x: PETSc.Vec, f: PETSc.Vec) -> bool:
        """Open closed pairs that hold bodies without force.

        A wall that moves away would draw them along. On springs they stay where they were after
        the last accepted step, unless the pairs close again.

        Returns:
            Whether a body became free; the pairs are closed again if none did.
        """
        balance, active = self._balance, self._balance.active
        if balance.contact.normal.follows_set:
            return False  # pairs whose force follows their gap hold nothing without force
        floating = balance.supports.floating
        released = active.release(balance.trial_forces, balance.convergence.smallest)
        if not active.any(released):
            return False
        balance.sum_up_again(x, f)
        if balance.supports.floating > floating:
            return True
        active.close(released)
        balance.sum_up_again(x, f)
        return False

    def _is_settled(self, f: PETSc.Vec, pull: float, slides: bool) -> bool:
        """Return whether the residual is small beside the pulls that would open pairs.

        As long as what flows or slides is not in equilibrium with the present set, a pair that is
        pulled says nothing, and those that opened by it would chatter.

        Args:
            f: the residual.
            pull: the largest pull of a pair beyond its limit [N].
            slides: whether it is small enough for friction to change its state.
        """
        balance = self._balance
        if balance.convergence.is_met(f):
            return True
        share = QUITE_CERTAIN if balance.active.one_by_one else CERTAIN
        return f.norm() <= share * pull and (slides or not balance.contact.has_friction)

    def _unsettled(self, forces: FloatArray) -> FloatArray:
        """Return the forces by which pairs close and open before they settle [N].

        Nothing opens but what has foretold pulls.

        Args:
            forces: of the iterate [N], shape (pairs,).
        """
        active = self._balance.active
        forces = np.where(active.closed, np.maximum(forces, 0.0), forces)
        if self.foretold is not None:
            certain = active.closed & (self._openings < MOST_FORETOLD)
            certain &= self.has_settled | ~active.held
            forces[certain] = self._balance.felt(self.foretold)[certain]
        return forces

    def violates(self) -> bool:
        """Return whether a pair pulls or penetrates by more than the balance of forces allows."""
        balance = self._balance
        felt = balance.felt(balance.trial_forces)
        return balance.active.violates(felt, balance.convergence.smallest)

    def shorten_to_contact(self, x: PETSc.Vec, y: PETSc.Vec) -> bool:
        """End the rigid motion of a body on springs, in a step to x − y, where it touches.

        Returns:
            Whether y has changed.
        """
        balance = self._balance
        springs = balance.operator.support
        if springs is None:
            return False
        limits = balance.convergence
        # Behind what counts as noise at any residual, else the pair would never close.
        threshold = max(NOISE_SHARE * limits.smallest, limits.rounding)
        force = 2 * balance.active.noise(balance.felt(balance.trial_forces), threshold)
        return self._first_contact.stop(springs, x, y, self._open_pairs, force, balance.stiffness)

    def shorten_overlap(self, x: PETSc.Vec, y: PETSc.Vec) -> bool:
        """End a step to x − y of metal that flows where open pairs pass through each other.

        Where sets of pairs return, the step stays as it is: they are judged by solutions.

        Returns:
            Whether y has changed.
        """
        balance, bodies = self._balance, self._balance.assembly
        if balance.active.cycles or bodies.is_linear or not bodies.flows_by_rate:
            return False
        depth = OVERLAP * min(body.length for body in bodies.bodies)
        return self._first_contact.stop_overlap(x, y, self._open_pairs, depth)

    @property
    def _open_pairs(self) -> BoolArray:
        """Pairs that close when they penetrate, shape (pairs,)."""
        active = self._balance.active
        return np.asarray(self._balance.gaps.free & ~active.closed & ~active.frozen)

    def improve_multipliers(self, x: PETSc.Vec, f: PETSc.Vec, balanced: bool) -> bool:
        """Improve the multipliers of the method, if it has any.

        Args:
            x: the iterate.
            f: its residual, filled anew if it has changed.
            balanced: whether it is small enough.

        Returns:
            Whether they changed, on any rank.
        """
        balance, enough = self._balance, self._balance.convergence.smallest
        closed = balance.active.closed
        if not balance.contact.improve_multipliers(balance.trial_forces, closed, balanced, enough):
            return False
        balance.sum_up_again(x, f)
        return True
