"""Open pairs, separated for preconditioners that solve body after body.

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
        T: I + N on the free rows, since the first `set_up`.
        matrix: TᵀAT since then.
    """

    def __init__(self, coupling: PETSc.Mat) -> None:
        # With the place of a diagonal, which few rows of N have: put in row by row, it would move
        # all entries behind it each time.
        self._coupling = coupling.copy()
        identity = _identity(coupling)
        self._coupling.axpy(1.0, identity)
        identity.destroy()
        self.T: PETSc.Mat | None = None
        self.matrix: PETSc.Mat | None = None
        self._work: list[PETSc.Vec] = []

    def set_up(self, matrix: PETSc.Mat, constrained: BoolArray) -> PETSc.Mat:
        """Return TᵀAT, which this object keeps.

        Args:
            matrix: A, whose constrained rows and columns are those of a diagonal.
            constrained: owned unknowns, shape (owned,).
        """
        self._free()
        free, ones = matrix.createVecRight(), matrix.createVecRight()
        free.array[:] = np.where(constrained, 0.0, 1.0)
        ones.set(1.0)
        self.T = self._coupling.copy()
        self.T.diagonalScale(free, free)
        self.T.setDiagonal(ones)
        self.matrix = matrix.ptap(self.T)
        self._work = [free, ones]
        return self.matrix

    def right_hand_side(self, b: PETSc.Vec) -> PETSc.Vec:
        """Return Tᵀb, until the next call."""
        assert self.T is not None
        self.T.multTranspose(b, self._work[0])
        return self._work[0]

    def restore(self, x: PETSc.Vec) -> None:
        """Replace the unknowns v' by v = T v'."""
        assert self.T is not None
        self.T.mult(x, self._work[1])
        self._work[1].copy(x)

    def _free(self) -> None:
        for item in (self.T, self.matrix, *self._work):
            if item is not None:
                item.destroy()
        self._work = []

    def destroy(self) -> None:
        """Destroy the matrices except the given coupling, which its owner destroys."""
        self._free()
        self._coupling.destroy()


def _identity(like: PETSc.Mat) -> PETSc.Mat:
    """Return the identity with the layout of a square matrix."""
    first, last = like.getOwnershipRange()
    pointers = np.arange(last - first + 1, dtype=PETSc.IntType)
    columns = np.arange(first, last, dtype=PETSc.IntType)
    pattern = pointers, columns, np.ones(last - first)
    return PETSc.Mat().createAIJ(like.getSizes(), csr=pattern, comm=like.getComm())
