"""Friction of penalty contact: return mapping of the tractions along the surface.

The trial traction of a closed pair is that of the last accepted step and ε times its motion since;
where it exceeds μ p it is scaled back to it, and the pair slips (P. Wriggers, Computational Contact
Mechanics, 2nd ed. 2006, section 10.5). Which pairs slip is decided once in an iteration, and at
first all stick: the elastic predictor.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.friction.coulomb import SlidingRows, forward, unit
from castx.contact.friction.penalty_slip import PenaltySlip, force_derivatives, tangent_matrix
from castx.contact.kinematics.active_set import ActiveSet
from castx.contact.kinematics.gaps import Gaps
from castx.contact.kinematics.iterate import ConstrainedRows, PairIterate
from castx.contact.kinematics.transform import ConstraintTransform


class PenaltyFriction:
    """Forces along the surface and their derivatives.

    Args:
        transform: change of unknowns of all bodies.
        body_names: names of the bodies in the order of the layout.
        gaps: the pairs of all interfaces.
        sliding: the rows with friction.
        normal_motions: ∂g/∂v of all rows; stays its owner's.
        springs: returns the present ε S of all rows [N/m].
    """

    def __init__(
        self,
        transform: ConstraintTransform,
        body_names: Sequence[str],
        gaps: Gaps,
        sliding: SlidingRows,
        normal_motions: PETSc.Mat,
        springs: Callable[[], FloatArray],
    ) -> None:
        self._gaps, self._sliding = gaps, sliding
        self._normal_motions, self._springs = normal_motions, springs
        tangents = tangent_matrix(transform.layout, body_names, gaps, sliding)
        self._G = tangents.matMult(transform.P)
        tangents.destroy()
        self._Gt = self._G.copy().transpose()
        self._values = self._G.createVecLeft()
        self._work = transform.layout.create_vector()
        shape = sliding.tangents.shape[:2]
        self._place, self._committed = np.zeros(shape), np.zeros(shape)
        self._force = np.zeros(shape)
        self._direction: FloatArray = np.zeros(shape)
        nothing, count = np.zeros(shape[0]), shape[0]
        self._imposed = PenaltySlip(np.zeros(count, dtype=bool), nothing, nothing, np.zeros(shape))
        some: BoolArray = np.any(sliding.tangents != 0.0, axis=(1, 2))
        # "Closed" are those that stick.
        signatures = gaps.signatures()[sliding.rows]
        self._sticks = ActiveSet(transform.layout.comm, np.zeros(count), some, signatures)

    def _motion(self, x: PETSc.Vec) -> FloatArray:
        """Return the tangential motion of pairs in this step [m]."""
        self._G.mult(x, self._values)
        moved = self._values.array_r.reshape(self._place.shape)
        return np.asarray(moved - self._sliding.primary_motion() - self._place)

    def begin(self) -> None:
        """Begin a solve from pairs that stick."""
        none = np.zeros_like(self._imposed.touching)
        self._imposed = PenaltySlip(
            none, self._imposed.springs, self._imposed.normal, self._imposed.trial
        )
        self._sticks.closed[:] = True
        self._sticks.begin()

    def sticking(self) -> BoolArray:
        """Return a mask of the sticking rows, on which the matrix depends."""
        return self._sticks.closed

    @property
    def _slips(self) -> BoolArray:
        return self._imposed.touching & ~self._sticks.closed

    def update(
        self, iterate: PairIterate, forces: FloatArray, threshold: float, settled: bool
    ) -> bool:
        """Let pairs slip or stick that violate their state; return whether any did, on any rank.

        What counts are the forces as last imposed.
        """
        touching, imposed = iterate.closed[self._sliding.rows], self._imposed
        most = self._sliding.coefficient * imposed.normal
        size = np.linalg.norm(imposed.trial, axis=1)
        ahead = np.sum(imposed.trial * self._direction, axis=1)
        present = self._sticks.closed.copy()
        directions, before = self._directions(), self._sticks.closed | ~touching
        known = touching & imposed.touching
        if self._sticks.any(touching != imposed.touching):
            # What comes into contact and has moved slips at once.
            self._sticks.closed = before & (known | (size <= most + threshold))
            self._sticks.restart_cycle_detection()
        # One that would slip the other way sticks before.
        inside = most - np.where(self._sticks.closed, size, ahead)
        may = known & (settled | ~self._sticks.closed)
        self._sticks.update(np.where(may, inside, 0.0), threshold)
        # Of the two, slip never bears more than friction can.
        self._sticks.closed &= ~self._sticks.frozen
        begins = before & ~self._sticks.closed
        self._direction = np.where(begins[:, None], unit(imposed.trial, directions), directions)
        return self._sticks.any(touching & (self._sticks.closed != present))

    def _directions(self) -> FloatArray:
        """Return unit vectors along the trial forces, former ones where they turned back."""
        return forward(self._imposed.trial, self._direction)

    def impose(self, iterate: PairIterate, forces: FloatArray, rows: ConstrainedRows) -> None:
        """Add the forces along the surface to rows."""
        chosen = self._sliding.rows
        springs = self._springs()[chosen]
        trial = self._committed + springs[:, None] * self._motion(iterate.x)
        self._imposed = PenaltySlip(
            iterate.closed[chosen], springs, np.maximum(forces[chosen], 0.0), trial
        )
        most = self._sliding.coefficient * self._imposed.normal
        slipping = most[:, None] * self._directions()
        self._force = np.where(self._slips[:, None], slipping, trial)
        self._force[~self._imposed.touching] = 0.0
        self._values.array[:] = self._force.ravel()
        self._Gt.mult(self._values, self._work)
        rows.forces += self._work.array_r

    def add_to(self, matrix: PETSc.Mat) -> PETSc.Mat:
        """Add the derivative of the forces as last imposed to the matrix of all rows."""
        along, across = force_derivatives(
            self._G, self._gaps.matrix, self._sliding, self._imposed, self._slips,
            self._directions(),
        )  # fmt: skip
        product = along.matMult(self._G)
        rest = across.matMult(self._normal_motions)
        product.axpy(1.0, rest)
        added = self._Gt.matMult(product)
        matrix.axpy(1.0, added)
        for item in (along, across, product, rest, added):
            item.destroy()
        return matrix

    def constraint_values(self, motions: FloatArray, closed: BoolArray) -> FloatArray:
        """Return the slip of sticking pairs under motions, shape (motions, rows); collective."""
        stuck = np.repeat(closed[self._sliding.rows] & self._sticks.closed, self._place.shape[1])
        values = np.zeros((len(motions), int(np.count_nonzero(stuck))))
        for row, motion in enumerate(motions):
            self._work.array[:] = motion
            self._G.mult(self._work, self._values)
            values[row] = self._values.array_r[stuck]
        return values

    def vectors(self, iterate: PairIterate) -> FloatArray:
        """Return the friction on the secondary nodes as last imposed [N], (rows, dimension)."""
        return self._sliding.vectors(-self._force)

    def commit(self, x: PETSc.Vec) -> None:
        """Let the next step begin with the present tractions and places, at unknowns x."""
        self._committed = self._force.copy()
        self._place += self._motion(x)

    def rewind(self, x: PETSc.Vec) -> None:
        """Return to the places of the last accepted step, whose unknowns are x."""
        self._place += self._motion(x)

    def saved(self) -> dict[str, FloatArray]:
        """Return the accepted forces along the surface of all rows."""
        found: dict[str, FloatArray] = {}
        for k in range(self._committed.shape[1]):
            values = np.zeros(len(self._gaps.local))
            values[self._sliding.rows] = self._committed[:, k]
            found[f"friction_{k}"] = values
        return found

    def restore(self, arrays: Mapping[str, FloatArray]) -> None:
        """Restore accepted forces along the surface."""
        for k in range(self._committed.shape[1]):
            self._committed[:, k] = arrays[f"friction_{k}"][self._sliding.rows]

    def destroy(self) -> None:
        """Free matrices and vectors."""
        for item in (self._G, self._Gt, self._values, self._work):
            item.destroy()
