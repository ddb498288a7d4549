"""Pairs that are open, taken apart for preconditioners that solve for one body after the other.

Where gaps are unknowns, a node is placed relative to the one that it faces, u_s = u_p + gap,
whether they touch or not: the nodes of one body move with the other one. Block by block a
preconditioner would iterate between bodies that do not act on each other. Row k of N is what v_k
has of the motion of facing points. With T = I + N on the rows that are free, v = T v' gives these
back to their own body, and M⁻¹ = T (TᵀAT)⁻¹ Tᵀ.
"""

from __future__ import annotations

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray


class Uncoupled:
    """The matrix TᵀAT in which rows that are free belong to their own body.

    Args:
        coupling: N, of which row k is what v_k has of other nodes than its own.

    Attributes:
        matrix: TᵀAT since the first `set_up`.
    """

    def __init__(self, coupling: PETSc.Mat) -> None:
        self._coupling = coupling
        self._T: PETSc.Mat | None = None
        self.matrix: PETSc.Mat | None = None
        self._work: list[PETSc.Vec] = []

    def set_up(self, matrix: PETSc.Mat, constrained: BoolArray) -> PETSc.Mat:
        """Return TᵀAT, which this object keeps.

        Args:
            matrix: A, whose constrained rows and columns are those of a diagonal.
            constrained: owned unknowns, shape (owned,).
        """
        self._free()
        free = matrix.createVecRight()
        free.array[:] = np.where(constrained, 0.0, 1.0)
        self._T = self._coupling.copy()
        self._T.diagonalScale(free, free)
        self._T.shift(1.0)
        self.matrix = matrix.ptap(self._T)
        self._work = [free, matrix.createVecRight()]
        return self.matrix

    def right_hand_side(self, b: PETSc.Vec) -> PETSc.Vec:
        """Return Tᵀb, until the next call."""
        assert self._T is not None
        self._T.multTranspose(b, self._work[0])
        return self._work[0]

    def restore(self, x: PETSc.Vec) -> None:
        """Replace the unknowns v' by v = T v'."""
        assert self._T is not None
        self._T.mult(x, self._work[1])
        self._work[1].copy(x)

    def _free(self) -> None:
        for item in (self._T, self.matrix, *self._work):
            if item is not None:
                item.destroy()
        self._work = []

    def destroy(self) -> None:
        """Free the matrices; the coupling is its owner's."""
        self._free()
