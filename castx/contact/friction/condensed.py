"""Friction of condensed contact: motions along the surface are unknowns, held while a pair sticks.

The force that holds them is the residual of their rows. A pair slips once it exceeds μ p S; from
then on its rows bear μ p S against the motion. With p S the residual of the row of the gap, a row
of motion becomes r_t + μ r_n d, and its derivative the same sum of rows of the matrix.
"""

from __future__ import annotations

from collections.abc import Mapping

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.friction.coulomb import SlidingRows, turned, unit
from castx.contact.kinematics.active_set import ActiveSet
from castx.contact.kinematics.gaps import Gaps
from castx.solvers.layout import Layout


class CondensedFriction:
    """Which pairs stick, and where the others go.

    Args:
        layout: numbering of the coordinates.
        gaps: the pairs of all interfaces.
        sliding: the rows with friction.
    """

    def __init__(self, layout: Layout, gaps: Gaps, sliding: SlidingRows) -> None:
        self._layout, self._gaps, self._sliding = layout, gaps, sliding
        count, width = sliding.local.shape
        keys = gaps.keys()[sliding.rows]
        some: BoolArray = np.any(sliding.local >= 0, axis=1)
        # "Closed" are those that stick.
        self._sticks = ActiveSet(layout.comm, np.zeros(count), some, keys)
        self._direction: FloatArray = np.zeros((count, width))
        self._committed_direction = self._direction.copy()
        self._place: FloatArray = np.zeros((count, width))
        self._matrix: PETSc.Mat | None = None
        # As last imposed: what slips, by what force, which way, how far.
        self._slips: BoolArray = np.zeros(count, dtype=bool)
        self._begins: BoolArray = np.zeros(count, dtype=bool)
        self._touching: BoolArray = np.ones(count, dtype=bool)
        self._stiffness = np.inf
        self._force: FloatArray = np.zeros(count)
        self._along: FloatArray = np.zeros((count, width))
        self._moved: FloatArray = np.zeros((count, width))

    def begin(self) -> None:
        """Start a solve from the pairs that stick now."""
        self._sticks.begin()
        self._begins[:], self._slips = False, np.zeros_like(self._slips)

    @property
    def changes(self) -> int:
        """Pairs that have begun to slip or to stick since `begin`."""
        return self._sticks.changes

    def state(self) -> BoolArray:
        """Return which pairs stick, on which the matrix depends."""
        return self._sticks.closed

    def _motion(self, x: PETSc.Vec) -> FloatArray:
        """Return how far pairs have moved along the surface in this step [m]."""
        local = self._sliding.local
        moved = np.where(local >= 0, x.array_r[np.maximum(local, 0)], 0.0)
        return np.asarray(moved - self._sliding.led() - self._place)

    def _forces(self, rows: FloatArray) -> FloatArray:
        local = self._sliding.local
        return np.where(local >= 0, rows[np.maximum(local, 0)], 0.0)

    def _directions(self, motion: FloatArray) -> FloatArray:
        """Return unit vectors along motions, the last ones where these vanish or turn back."""
        # What has just begun to slip has not moved yet.
        found = turned(motion, self._direction)
        return np.where(self._begins[:, None], self._direction, found)

    def impose(
        self,
        x: PETSc.Vec,
        forces: FloatArray,
        closed: BoolArray,
        rows: FloatArray,
        held: BoolArray,
        violation: FloatArray,
    ) -> None:
        """Hold what sticks, and let what slips bear its friction."""
        local, touching = self._sliding.local, closed[self._sliding.rows]
        there, self._moved = local >= 0, self._motion(x)
        stuck = (touching & self._sticks.closed)[:, None] & there
        held[local[stuck]] = True
        violation[local[stuck]] = self._moved[stuck]
        self._touching = touching
        self._slips = touching & ~self._sticks.closed
        most = self._sliding.coefficient * np.maximum(forces[self._sliding.rows], 0.0)
        self._force = np.where(self._slips, most, 0.0)
        self._along = self._directions(self._moved)
        rows[local[there]] += (self._force[:, None] * self._along)[there]

    def update(
        self, x: PETSc.Vec, rows: FloatArray, forces: FloatArray, closed: BoolArray,
        stiffness: float, threshold: float, settled: bool,
    ) -> bool:  # fmt: skip
        """Let pairs slip or stick that violate their state; return whether any did, on any rank.

        Args:
            x: the iterate.
            rows: before the pairs act.
            forces: normal forces of all rows [N].
            closed: the present set of closed pairs.
            stiffness: force per motion by which a motion against the friction is measured [N/m].
            threshold: force that is noise [N].
            settled: whether what sticks may begin to slip.
        """
        touching = closed[self._sliding.rows]
        present = self._sticks.closed.copy()
        known, before = touching & self._touching, self._sticks.closed | ~touching
        carried = self._forces(rows)
        size = np.linalg.norm(carried, axis=1)
        most = self._sliding.coefficient * np.maximum(forces[self._sliding.rows], 0.0)
        motion = self._motion(x)
        forward = np.sum(motion * self._direction, axis=1)
        directions = self._directions(motion)
        if self._sticks.any(touching != self._touching):
            # What comes into contact and has moved slips at once.
            moved = stiffness * np.linalg.norm(motion, axis=1) > threshold
            self._sticks.closed = before & (known | ~(touching & moved))
            self._sticks.forget()
        trial = np.where(self._sticks.closed, most - size, -stiffness * forward)
        may = known & (settled | ~self._sticks.closed)
        self._sticks.update(np.where(may, trial, 0.0), threshold)
        # Of the two, slip never bears more than friction can.
        self._sticks.closed &= ~self._sticks.frozen
        self._stiffness = stiffness
        self._begins = before & ~self._sticks.closed
        along = np.where(known[:, None], -carried, motion)
        self._direction = np.where(self._begins[:, None], unit(along, directions), directions)
        return self._sticks.any(touching & (self._sticks.closed != present))

    def matrix(self, normal: PETSc.Mat) -> PETSc.Mat:
        """Return the derivative of the rows as last imposed; the next call overwrites it.

        Args:
            normal: matrix of the coordinates without friction.
        """
        mixing = self._layout.create_vector()
        rows = PETSc.Mat().createAIJ(
            ((self._layout.size_local, self._layout.size_global),) * 2, nnz=4,
            comm=self._layout.comm,
        )  # fmt: skip
        rows.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
        mixing.set(1.0)
        rows.setDiagonal(mixing)
        mixing.destroy()
        first, gap = self._layout.first, self._gaps.local[self._sliding.rows]
        pressed = self._slips & (self._force > 0)
        shares = np.where(pressed, self._sliding.coefficient, 0.0)[:, None] * self._along
        for i, k in np.argwhere(self._sliding.local >= 0):
            place = first + int(self._sliding.local[i, k])
            rows.setValue(place, first + int(gap[i]), shares[i, k])
        rows.assemble()
        product = rows.matMult(normal)
        rows.destroy()
        if self._along.shape[1] > 1:
            self._add_turning(product)
        if self._matrix is not None:
            self._matrix.destroy()
        self._matrix = product
        return product

    def _add_turning(self, product: PETSc.Mat) -> None:
        """Add μ p S ∂d/∂v = μ p S (1 - d dᵀ)/|Δv|: friction turns with the motion."""
        first, size = self._layout.first, np.linalg.norm(self._moved, axis=1)
        product.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
        follows = np.sum(self._moved * self._along, axis=1) > 0.0
        for i in np.flatnonzero(self._slips & follows & ~self._begins):
            there, d = self._sliding.local[i] >= 0, self._along[i]
            # Steeper than the bodies it would only spoil the matrix.
            slope = min(self._force[i] / size[i], 1e3 * self._stiffness)
            block = slope * (np.eye(len(d)) - np.outer(d, d))
            numbers = (first + self._sliding.local[i][there]).astype(np.int32)
            product.setValues(
                numbers, numbers, block[np.ix_(there, there)], PETSc.InsertMode.ADD_VALUES
            )
        product.assemble()

    def vectors(self, rows: FloatArray, closed: BoolArray) -> FloatArray:
        """Return the friction on the secondary nodes of all rows [N], shape (rows, dimension).

        What sticks bears the residuals of its rows; of what slips these hold supports as well.
        """
        touching = closed[self._sliding.rows]
        normal = np.maximum(rows[self._gaps.local[self._sliding.rows]], 0.0)
        slipping = -(self._sliding.coefficient * normal)[:, None] * self._along
        borne = np.where(self._sticks.closed[:, None], self._forces(rows), slipping)
        return self._sliding.vectors(np.where(touching[:, None], borne, 0.0))

    def commit(self, x: PETSc.Vec) -> None:
        """Let the next step begin where the pairs are now, at unknowns x."""
        self._sticks.commit()
        self._committed_direction = self._direction.copy()
        self._place += self._motion(x)

    def rewind(self, x: PETSc.Vec) -> None:
        """Return to the pairs and places of the last accepted step, whose unknowns are x."""
        self._sticks.rewind()
        self._direction = self._committed_direction.copy()
        self._place += self._motion(x)

    def saved(self) -> dict[str, FloatArray]:
        """Return which pairs stick and where the others go, of all rows."""
        count, width = len(self._gaps.local), self._direction.shape[1]
        found: dict[str, FloatArray] = {"sticks": np.ones(count)}
        found["sticks"][self._sliding.rows] = self._sticks.committed
        for k in range(width):
            along = np.zeros(count)
            along[self._sliding.rows] = self._committed_direction[:, k]
            found[f"sliding_{k}"] = along
        return found

    def restore(self, arrays: Mapping[str, FloatArray]) -> None:
        """Take back which pairs stick and where the others go."""
        rows = self._sliding.rows
        for k in range(self._direction.shape[1]):
            self._committed_direction[:, k] = arrays[f"sliding_{k}"][rows]
        self._sticks.restore(arrays["sticks"][rows].astype(bool))

    def destroy(self) -> None:
        """Free the matrix."""
        if self._matrix is not None:
            self._matrix.destroy()
