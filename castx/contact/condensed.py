"""Condensed contact: the gap of every pair is one of the unknowns (no penalty, no multiplier).

With u = P v the matrix is PᵀAP and the residual Pᵀr; a closed pair is the Dirichlet condition
v_k = -g0 and its contact force p_c S the residual of that row. Where the primary body is rigid, P
only turns the axes at each node, and the method is that of Chiumenti, end of section 8.
"""

from __future__ import annotations

from collections.abc import Mapping

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.friction.condensed import CondensedFriction
from castx.contact.kinematics.coordinates import Coordinates
from castx.contact.kinematics.gaps import Gaps
from castx.solvers.layout import Layout


class CondensedContact:
    """The unknowns v, in which gaps are coordinates.

    Args:
        coordinates: condensed coordinates of all bodies.
        gaps: the pairs of all interfaces.
        friction: of the pairs that have any.
    """

    def __init__(
        self, coordinates: Coordinates, gaps: Gaps, friction: CondensedFriction | None = None
    ) -> None:
        self.follows_set = self.follows_motion = friction is not None
        self._friction = friction
        self.layout: Layout = coordinates.layout
        self._P = coordinates.to_displacements
        self._gaps = gaps
        self._residual = self.layout.create_vector()
        self._matrix: PETSc.Mat | None = None

    def prepare(self, A: PETSc.Mat) -> None:
        """Begin a solve."""
        if self._friction is not None:
            self._friction.begin()

    def displacements(self, x: PETSc.Vec, u: PETSc.Vec) -> None:
        """Set the displacements and pressures of all bodies from the unknowns."""
        self._P.mult(x, u)

    def residual(self, x: PETSc.Vec, r: PETSc.Vec) -> FloatArray:
        """Return the owned rows of the residual without contact from r, that of the bodies."""
        self._P.multTranspose(r, self._residual)
        return self._residual.array_r.copy()

    def update_bodies(self, A: PETSc.Mat) -> None:
        """Take over A as PᵀAP."""
        if self._matrix is None:
            self._matrix = A.ptap(self._P)
        else:
            A.ptap(self._P, self._matrix)

    def matrix(self, closed: BoolArray) -> PETSc.Mat:
        """Return PᵀAP, whichever pairs are closed: they hold unknowns; with friction its rows."""
        if self._friction is not None:
            return self._friction.matrix(self._matrix)
        return self._matrix

    def gaps(self, x: PETSc.Vec, u: PETSc.Vec) -> FloatArray:
        """Return the gaps of all pairs [m]; exact zero where a pair is closed."""
        gaps = self._gaps.values(u)
        free = self._gaps.free
        gaps[free] = x.array_r[self._gaps.local[free]] + self._gaps.initial[free]
        return gaps

    def trial_forces(
        self, x: PETSc.Vec, rows: FloatArray, gaps: FloatArray, closed: BoolArray, stiffness: float
    ) -> FloatArray:
        """Return the residual of the rows of closed pairs, -stiffness times gap of open ones."""
        forces = -stiffness * gaps
        forces[closed] = rows[self._gaps.local[closed]]
        return forces

    def impose(
        self,
        x: PETSc.Vec,
        forces: FloatArray,
        closed: BoolArray,
        rows: FloatArray,
        held: BoolArray,
        violation: FloatArray,
    ) -> None:
        """Mark the unknowns that closed pairs hold, with their distance from their place [m]."""
        local = self._gaps.local[closed]
        held[local] = True
        violation[local] = x.array_r[local] + self._gaps.initial[closed]
        if self._friction is not None:
            self._friction.impose(x, forces, closed, rows, held, violation)

    def augment(
        self, forces: FloatArray, closed: BoolArray, balanced: bool, enough: float
    ) -> bool:
        """Return that nothing changed: the forces of closed pairs are exact."""
        return False

    def constraint_values(self, motions: FloatArray, closed: BoolArray) -> None:
        """Return further constraint rows: none, since closed pairs hold unknowns."""
        return None

    def to_unknowns(self, coordinates: FloatArray) -> FloatArray:
        """Return the coordinates: they are the unknowns."""
        return coordinates

    def state(self, closed: BoolArray) -> BoolArray:
        """Return which pairs close and stick if there is friction."""
        if self._friction is None:
            return closed[:0]
        return np.concatenate((closed, self._friction.state()))

    def slide(
        self, x: PETSc.Vec, rows: FloatArray, forces: FloatArray, closed: BoolArray,
        stiffness: float, threshold: float, settled: bool,
    ) -> bool:  # fmt: skip
        """Let closed pairs begin to slip or to stick; return whether any did, on any rank."""
        if self._friction is None:
            return False
        return self._friction.update(x, rows, forces, closed, stiffness, threshold, settled)

    def along_surface(self, x: PETSc.Vec, rows: FloatArray, closed: BoolArray) -> FloatArray | None:
        """Return the friction on secondary nodes [N], (rows, dimension); None: there is none."""
        return None if self._friction is None else self._friction.vectors(rows, closed)

    def commit(self, x: PETSc.Vec) -> None:
        """Let friction begin anew; all else that lasts is in the unknowns."""
        if self._friction is not None:
            self._friction.commit(x)

    def rewind(self, x: PETSc.Vec) -> None:
        """Return to the friction of the last accepted step."""
        if self._friction is not None:
            self._friction.rewind(x)

    def saved(self) -> dict[str, FloatArray]:
        """Return what friction remembers."""
        return {} if self._friction is None else self._friction.saved()

    def restore(self, arrays: Mapping[str, FloatArray]) -> None:
        """Take back what friction remembers."""
        if self._friction is not None:
            self._friction.restore(arrays)

    def destroy(self) -> None:
        """Free the matrix and vectors."""
        if self._friction is not None:
            self._friction.destroy()
        for item in (self._matrix, self._residual):
            if item is not None:
                item.destroy()
