"""Friction of condensed contact: motions along the surface are unknowns, constrained while stuck.

The force that constrains them is the residual of their rows. A pair slips once it exceeds μ p S;
from then on its rows bear μ p S against the motion. With p S the residual of the row of the gap, a
row of motion becomes r_t + μ r_n d, and its derivative the same sum of rows of the matrix.

A pair that chatters between both is held by a spring. It bears min(c ‖Δv‖, μ p S) against the
motion Δv in the step, so that friction cannot act along it, whatever the direction was before.
"""

from __future__ import annotations

from collections.abc import Mapping

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.friction.condensed_slip import SlipState, matrix_with_slip
from castx.contact.friction.coulomb import SlidingRows, forward, shortened, unit
from castx.contact.kinematics.active_set import ActiveSet
from castx.contact.kinematics.gaps import Gaps
from castx.contact.kinematics.iterate import ConstrainedRows, PairIterate
from castx.solvers.layout import Layout

SPRING = 0.1
"""Stiffness of the springs of pairs that chatter, beside that of rows that have none of their own.
Stiffer ones chatter themselves: a casting in space, whose steps were cut 9 times without springs,
has 1 cut and 548 iterations with 0.1, and 13 cuts and 1457 iterations after 53 steps with 1."""


class CondensedFriction:
    """Stick states and slip directions of the pairs.

    Args:
        layout: numbering of the unknowns.
        gaps: the pairs of all interfaces.
        sliding: the rows with friction.
    """

    def __init__(self, layout: Layout, gaps: Gaps, sliding: SlidingRows) -> None:
        self._layout, self._gaps, self._sliding = layout, gaps, sliding
        count, width = sliding.local.shape
        some: BoolArray = np.any(sliding.local >= 0, axis=1)
        # "Closed" are those that stick.
        signatures = gaps.signatures()[sliding.rows]
        self._sticks = ActiveSet(layout.comm, np.zeros(count), some, signatures)
        self._direction: FloatArray = np.zeros((count, width))
        self._committed_direction = self._direction.copy()
        self._place: FloatArray = np.zeros((count, width))
        self._matrix: PETSc.Mat | None = None
        self._begins: BoolArray = np.zeros(count, dtype=bool)
        self._touching: BoolArray = np.ones(count, dtype=bool)
        self._stiffness = np.inf
        self._imposed = SlipState.none(count, width)

    def begin(self) -> None:
        """Begin a solve from the pairs that stick now."""
        self._sticks.begin()
        self._begins[:] = False
        self._imposed = self._imposed.without_slip()

    def sticking(self) -> BoolArray:
        """Return a mask of the sticking rows, on which the matrix depends."""
        return self._sticks.closed

    def _motion(self, x: PETSc.Vec) -> FloatArray:
        """Return the tangential motion of pairs in this step [m]."""
        moved = self._along(x.array_r)
        return np.asarray(moved - self._sliding.primary_motion() - self._place)

    def _along(self, rows: FloatArray) -> FloatArray:
        """Return values of rows, (…, rows), at the motions of pairs, zero where there is none."""
        local = self._sliding.local
        return np.where(local >= 0, rows[..., np.maximum(local, 0)], 0.0)

    def _directions(self, motion: FloatArray) -> FloatArray:
        """Return unit vectors along motions, former ones where these vanish or turn back.

        Those of pairs that chatter may turn back.
        """
        # What has just begun to slip has not moved yet.
        found = forward(motion, self._direction)
        found = np.where(self._begins[:, None], self._direction, found)
        return np.where(self._sticks.frozen[:, None], unit(motion, self._direction), found)

    def _limits(self, forces: FloatArray) -> FloatArray:
        """Return the largest forces along the surface [N]."""
        normal = np.maximum(forces[self._sliding.rows], 0.0)
        return np.asarray(self._sliding.coefficient * normal)

    def impose(self, iterate: PairIterate, forces: FloatArray, rows: ConstrainedRows) -> None:
        """Constrain the motions that stick, and let slipping pairs bear their friction."""
        local, touching = self._sliding.local, iterate.closed[self._sliding.rows]
        there, moved = local >= 0, self._motion(iterate.x)
        stuck = (touching & self._sticks.closed)[:, None] & there
        rows.constrain(local[stuck], moved[stuck])
        self._touching = touching
        slips = touching & ~self._sticks.closed
        force = np.where(slips, self._limits(forces), 0.0)
        self._imposed = self._slip(iterate, slips, force, moved)
        rows.forces[local[there]] += (force[:, None] * self._imposed.along)[there]

    def _slip(
        self, iterate: PairIterate, slips: BoolArray, force: FloatArray, moved: FloatArray
    ) -> SlipState:
        """Return the friction of the rows that slip, by their springs where they chatter."""
        chatters, springs = slips & self._sticks.frozen, SPRING * iterate.stiffness
        directions, borne = self._directions(moved), -self._along(iterate.rows)
        along = np.where(chatters[:, None], shortened(springs * moved, force), directions)
        carried = np.where(chatters[:, None], shortened(borne, force), directions)
        return SlipState(slips, force, along, moved, chatters, carried, springs)

    def update(
        self, iterate: PairIterate, forces: FloatArray, threshold: float, settled: bool
    ) -> bool:
        """Let pairs slip or stick that violate their state; return whether any did, on any rank."""
        touching, stiffness = iterate.closed[self._sliding.rows], iterate.stiffness
        present, chattered = self._sticks.closed.copy(), self._sticks.frozen.copy()
        known, before = touching & self._touching, self._sticks.closed | ~touching
        carried = self._along(iterate.rows)
        size = np.linalg.norm(carried, axis=1)
        motion = self._motion(iterate.x)
        ahead = np.sum(motion * self._direction, axis=1)
        directions = self._directions(motion)
        if self._sticks.any(touching != self._touching):
            # What comes into contact and has moved slips at once.
            moved = stiffness * np.linalg.norm(motion, axis=1) > threshold
            self._sticks.closed = before & (known | ~(touching & moved))
            self._sticks.restart_cycle_detection()
        inside = self._limits(forces) - size
        trial = np.where(self._sticks.closed, inside, -stiffness * ahead)
        may = known & (settled | ~self._sticks.closed)
        self._sticks.update(np.where(may, trial, 0.0), threshold)
        # What chatters slips from now on, by a spring that bears no more than friction can.
        self._sticks.closed &= ~self._sticks.frozen
        changed = (self._sticks.closed != present) | (self._sticks.frozen != chattered)
        self._stiffness = stiffness
        self._begins = before & ~self._sticks.closed
        along = np.where(known[:, None], -carried, motion)
        self._direction = np.where(self._begins[:, None], unit(along, directions), directions)
        return self._sticks.any(touching & changed)

    def add_to(self, matrix: PETSc.Mat) -> PETSc.Mat:
        """Return the derivative of the rows as last imposed; the next call overwrites it."""
        found = matrix_with_slip(
            matrix, self._layout, self._gaps, self._sliding, self._imposed,
            self._imposed.slips & ~self._begins, 1e3 * self._stiffness,
        )  # fmt: skip
        if self._matrix is not None:
            self._matrix.destroy()
        self._matrix = found
        return found

    def constraint_values(self, motions: FloatArray, closed: BoolArray) -> FloatArray:
        """Return the parts of motions that pairs which chatter resist, shape (motions, rows).

        Supports would fight their springs. Other motions that stick are constrained unknowns.
        """
        return self._imposed.resisted(self._along(motions))

    def vectors(self, iterate: PairIterate) -> FloatArray:
        """Return the friction on the secondary nodes of all rows [N], shape (rows, dimension).

        A pair that sticks bears the residuals of its rows; those of one that slips also hold the
        forces of supports.
        """
        rows, touching = iterate.rows, iterate.closed[self._sliding.rows]
        normal = np.maximum(rows[self._gaps.local[self._sliding.rows]], 0.0)
        slipping = -(self._sliding.coefficient * normal)[:, None] * self._imposed.along
        borne = np.where(self._sticks.closed[:, None], self._along(rows), slipping)
        return self._sliding.vectors(np.where(touching[:, None], borne, 0.0))

    def commit(self, x: PETSc.Vec) -> None:
        """Let the next step begin at the present places of the pairs, at unknowns x."""
        self._sticks.closed |= self._imposed.holds
        self._sticks.commit()
        self._committed_direction = self._direction.copy()
        self._place += self._motion(x)

    def rewind(self, x: PETSc.Vec) -> None:
        """Return to the stick states and places of the last accepted step, whose unknowns are x."""
        self._sticks.rewind()
        self._direction = self._committed_direction.copy()
        self._place += self._motion(x)

    def saved(self) -> dict[str, FloatArray]:
        """Return stick states and slip directions of all rows."""
        count, width = len(self._gaps.local), self._direction.shape[1]
        found: dict[str, FloatArray] = {"sticks": np.ones(count)}
        found["sticks"][self._sliding.rows] = self._sticks.committed
        for k in range(width):
            along = np.zeros(count)
            along[self._sliding.rows] = self._committed_direction[:, k]
            found[f"sliding_{k}"] = along
        return found

    def restore(self, arrays: Mapping[str, FloatArray]) -> None:
        """Restore stick states and slip directions."""
        rows = self._sliding.rows
        for k in range(self._direction.shape[1]):
            self._committed_direction[:, k] = arrays[f"sliding_{k}"][rows]
        self._sticks.restore(arrays["sticks"][rows].astype(bool))

    def destroy(self) -> None:
        """Free the matrix."""
        if self._matrix is not None:
            self._matrix.destroy()
