"""Soft contact (Chiumenti, section 7): the force of a pair is a function of its gap, f = S p_c(g).

In the unknowns of the bodies the rows are Pᵀr - Gᵀf with G = ∂g/∂v, the matrix
PᵀAP + Gᵀ diag(-∂f/∂g) G over the closed pairs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.kinematics.gaps import Gaps
from castx.contact.kinematics.iterate import ConstrainedRows, PairIterate
from castx.contact.kinematics.transform import ConstraintTransform
from castx.contact.methods.description import PairLaw
from castx.contact.unknowns import TransformedUnknowns


class SoftContact:
    """Forces by the pair laws of the interfaces, with the displacements of the bodies as unknowns.

    Attributes:
        unknowns: those of the bodies.
        gap_matrix: G = ∂g/∂v of all rows.

    Args:
        transform: change of unknowns of all bodies, in which gaps are no unknowns.
        gaps: the pairs of all interfaces.
        laws: of each interface.
        stiffness: returns the present ε S of all rows [N/m].
        multipliers: returns the present λ S of all rows [N].
    """

    follows_set = True

    def __init__(
        self,
        transform: ConstraintTransform,
        gaps: Gaps,
        laws: Sequence[PairLaw],
        stiffness: Callable[[], FloatArray],
        multipliers: Callable[[], FloatArray],
    ) -> None:
        self.unknowns = TransformedUnknowns(transform)
        self._gaps, self._P, self._laws = gaps, transform.P, list(laws)
        self._stiffness, self._multipliers = stiffness, multipliers
        self.is_linear = all(law.is_linear for law in laws)
        self.gap_matrix = gaps.matrix.matMult(self._P)
        self._Gt = self.gap_matrix.copy().transpose()
        self._pairs = self.gap_matrix.createVecLeft()
        self._work = self.unknowns.layout.create_vector()
        self._bodies: PETSc.Mat | None = None
        self._scaled: PETSc.Mat | None = None
        self._contact: PETSc.Mat | None = None
        self._matrix: PETSc.Mat | None = None

    def update_bodies(self, A: PETSc.Mat) -> None:
        """Take over A as PᵀAP."""
        if self._bodies is None:
            self._bodies = A.ptap(self._P)
        else:
            A.ptap(self._P, self._bodies)

    def matrix(self, iterate: PairIterate) -> PETSc.Mat:
        """Return PᵀAP + Gᵀ diag(-∂f/∂g) G over the closed pairs; the next call overwrites it."""
        assert self._bodies is not None
        self._pairs.array[:] = np.where(iterate.closed, self._slopes(iterate.gaps), 0.0)
        if self._scaled is None:
            self._scaled = self.gap_matrix.copy()
        else:
            self.gap_matrix.copy(self._scaled)
        self._scaled.diagonalScale(self._pairs, None)
        structure = PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN
        if self._contact is None or self._matrix is None:
            self._contact = self._Gt.matMult(self._scaled)
            self._matrix = self._bodies.copy()
            self._matrix.axpy(1.0, self._contact)
        else:
            self._Gt.matMult(self._scaled, self._contact)
            self._matrix.zeroEntries()
            self._matrix.axpy(1.0, self._bodies, structure)
            self._matrix.axpy(1.0, self._contact, structure)
        return self._matrix

    def gaps(self, x: PETSc.Vec, u: PETSc.Vec) -> FloatArray:
        """Return the gaps of all pairs [m], negative where they penetrate."""
        return self._gaps.values(u)

    def trial_forces(self, iterate: PairIterate) -> FloatArray:
        """Return the forces by the pair laws [N], closed or not."""
        return self._by_interface(iterate.gaps, [law.force for law in self._laws])

    def _slopes(self, gaps: FloatArray) -> FloatArray:
        return self._by_interface(gaps, [law.slope for law in self._laws])

    def _by_interface(
        self, gaps: FloatArray, functions: Sequence[Callable[..., FloatArray]]
    ) -> FloatArray:
        found: FloatArray = np.zeros(len(gaps))
        arrays = (gaps, self._gaps.areas, self._stiffness(), self._multipliers())
        for part, function in zip(self._gaps.slices, functions, strict=True):
            found[part] = function(*(array[part] for array in arrays))
        return found

    def impose(self, iterate: PairIterate, forces: FloatArray, rows: ConstrainedRows) -> None:
        """Let the closed pairs push their nodes."""
        self._pairs.array[:] = np.where(iterate.closed, forces, 0.0)
        self._Gt.mult(self._pairs, self._work)
        rows.forces -= self._work.array_r

    def constraint_values(self, motions: FloatArray, closed: BoolArray) -> FloatArray:
        """Return the changes of the gaps of closed pairs by motions, shape (motions, closed)."""
        values = np.zeros((len(motions), int(np.count_nonzero(closed))))
        for row, motion in enumerate(motions):
            self._work.array[:] = motion
            self.gap_matrix.mult(self._work, self._pairs)
            values[row] = self._pairs.array_r[closed]
        return values

    def destroy(self) -> None:
        """Free matrices and vectors."""
        for item in (self._matrix, self._contact, self._scaled, self._bodies):
            if item is not None:
                item.destroy()
        for item in (self.gap_matrix, self._Gt, self._pairs, self._work, self.unknowns):
            item.destroy()
