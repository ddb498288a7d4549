"""Condensed contact: the gap of every pair is one of the unknowns (no penalty, no multiplier).

With u = P v the matrix is PᵀAP and the residual Pᵀr; a closed pair is the Dirichlet condition
v_k = -g0 and its contact force p_c S the residual of that row. Where the primary body is rigid, P
only turns the axes at each node, and the method is that of Chiumenti, end of section 8.
"""

from __future__ import annotations

from petsc4py import PETSc

from castx.arrays import BoolArray, FloatArray
from castx.contact.kinematics.gaps import Gaps
from castx.contact.kinematics.iterate import ConstrainedRows, PairIterate
from castx.contact.kinematics.transform import ConstraintTransform
from castx.contact.unknowns import TransformedUnknowns


class CondensedContact:
    """Closed pairs as Dirichlet conditions on the unknowns v, of which gaps are some.

    Attributes:
        unknowns: those of the bodies.

    Args:
        transform: change of unknowns of all bodies, in which gaps are unknowns.
        gaps: the pairs of all interfaces.
    """

    follows_set, is_linear = False, True

    def __init__(self, transform: ConstraintTransform, gaps: Gaps) -> None:
        self.unknowns = TransformedUnknowns(transform)
        self._P, self._gaps = transform.P, gaps
        self._matrix: PETSc.Mat | None = None

    def update_bodies(self, A: PETSc.Mat) -> None:
        """Take over A as PᵀAP."""
        if self._matrix is None:
            self._matrix = A.ptap(self._P)
        else:
            A.ptap(self._P, self._matrix)

    def matrix(self, iterate: PairIterate) -> PETSc.Mat:
        """Return PᵀAP, whichever pairs are closed: they constrain unknowns."""
        return self._matrix

    def gaps(self, x: PETSc.Vec, u: PETSc.Vec) -> FloatArray:
        """Return the gaps of all pairs [m]; exact zero where a pair is closed."""
        gaps = self._gaps.values(u)
        free = self._gaps.free
        gaps[free] = x.array_r[self._gaps.local[free]] + self._gaps.initial[free]
        return gaps

    def trial_forces(self, iterate: PairIterate) -> FloatArray:
        """Return the residual in rows of closed pairs, minus stiffness times gap in open ones."""
        forces = -iterate.stiffness * iterate.gaps
        forces[iterate.closed] = iterate.rows[self._gaps.local[iterate.closed]]
        return forces

    def impose(self, iterate: PairIterate, forces: FloatArray, rows: ConstrainedRows) -> None:
        """Constrain the gaps of closed pairs, which are as far off as they are open."""
        closed = iterate.closed
        rows.constrain(self._gaps.local[closed], iterate.gaps[closed])

    def constraint_values(self, motions: FloatArray, closed: BoolArray) -> None:
        """Return no further constraint rows, since closed pairs constrain unknowns."""
        return None

    def destroy(self) -> None:
        """Free the matrix and vectors."""
        if self._matrix is not None:
            self._matrix.destroy()
        self.unknowns.destroy()
