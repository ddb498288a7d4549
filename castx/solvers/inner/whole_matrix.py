"""Matrices to be factorised, with what is applied beside them, in one Mat.

Factors are exact only of the whole matrix: without the projection of OSGS they need 30 iterations
where a skin freezes. Of each new Mat PETSc analyses the pattern, for a third of the cost of its
factors; one that stays is analysed once.
"""

from __future__ import annotations

from collections.abc import Callable

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray

Lacking = Callable[[], PETSc.Mat | None]
"""Returns what an assembled matrix lacks, which the caller destroys; None: nothing."""


class WholeMatrix:
    """The sum of an assembled matrix and what it lacks, one Mat as long as its pattern stays.

    Args:
        lacking: returns what the matrix lacks.

    Attributes:
        matrix: the sum, since the first `update`.
    """

    def __init__(self, lacking: Lacking | None = None) -> None:
        self._lacking = lacking
        self.matrix: PETSc.Mat | None = None

    def update(self, matrix: PETSc.Mat, constrained: BoolArray) -> PETSc.Mat:
        """Return the sum, which this object keeps; collective.

        Args:
            matrix: whose constrained rows and columns are those of a diagonal.
            constrained: owned unknowns, shape (owned,).
        """
        total = matrix.copy()
        lacking = None if self._lacking is None else self._lacking()
        if lacking is not None:
            keep = total.createVecRight()
            keep.array[:] = np.where(constrained, 0.0, 1.0)
            lacking.diagonalScale(keep, keep)
            total.axpy(1.0, lacking, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
            lacking.destroy()
            keep.destroy()
        if self.matrix is not None and _same_pattern(total, self.matrix):
            total.copy(self.matrix, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
            total.destroy()
        else:
            self.destroy()
            self.matrix = total
        return self.matrix

    def destroy(self) -> None:
        """Free the matrix."""
        if self.matrix is not None:
            self.matrix.destroy()
        self.matrix = None


def _same_pattern(first: PETSc.Mat, second: PETSc.Mat) -> bool:
    """Return whether two matrices have entries in the same places; collective."""
    (rows, columns, _), (others, there, _) = first.getValuesCSR(), second.getValuesCSR()
    same = np.array_equal(rows, others) and np.array_equal(columns, there)
    return bool(first.getComm().tompi4py().allreduce(same, op=MPI.LAND))
