"""Stiff nodes of a body that is soft elsewhere, solved for before multigrid sees the rest.

A skin or a few cells that freeze in a liquid are 10⁴ times stiffer than what surrounds them, and
hardly held by it. They bend with almost no resistance, in shapes that aggregates of stiff and soft
nodes do not know. There are few of them, so that factors cost little; once a shell is thick it
resists bending, and multigrid needs no help.

Source: the subspace correction of J. Xu, SIAM Review 34 (1992), with a subspace of its own for the
inclusions, as in I. G. Graham and R. Scheichl, Numerische Mathematik 106 (2007).
"""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.solvers.inner.entries import diagonal

STIFF = 30.0
"""Stiffness of a node beside that of the softest one of its body from which on it is stiff."""

CHEAP, LARGEST_SHARE, MOST = 10_000, 0.4, 50_000
"""Unknowns whose factors cost no more than to prepare multigrid, whatever their shape; part of the
unknowns of a body, and their number, up to which they are a skin with little fill-in."""


class StiffPart:
    """Solves exactly for the stiff nodes of all bodies, and leaves the rest of the residual.

    Args:
        comm: communicator of the matrix.
        prefix: prefix of its PETSc options, which are read whenever it is prepared.
        rows: owned global indices of each body, with the number of unknowns of its nodes.
    """

    def __init__(self, comm: MPI.Intracomm, prefix: str, rows: Sequence[PETSc.IS]) -> None:
        self._comm, self._prefix = comm, prefix
        self._bodies = [(part.getIndices().copy(), part.getBlockSize()) for part in rows]
        self._matrix: PETSc.Mat | None = None
        self._items: list[PETSc.Object] = []

    def set_up(self, matrix: PETSc.Mat, constrained: BoolArray) -> None:
        """Find the stiff nodes and factorise their matrix.

        Args:
            matrix: whose constrained rows and columns are those of a diagonal.
            constrained: owned unknowns, shape (owned,).
        """
        self._free()
        self._matrix = matrix
        stiffness = np.where(constrained, 0.0, diagonal(matrix))
        first = matrix.getOwnershipRange()[0]
        found = [self._stiff(part - first, size, stiffness) for part, size in self._bodies]
        unknowns = np.concatenate([np.zeros(0, dtype=np.int64), *found])
        unknowns = unknowns[~constrained[unknowns]] + first
        if self._comm.allreduce(len(unknowns), op=MPI.SUM) == 0:
            return
        rows = PETSc.IS().createGeneral(np.sort(unknowns).astype(np.int32), comm=self._comm)
        block = matrix.createSubMatrix(rows, rows)
        ksp = PETSc.KSP().create(self._comm)
        ksp.setOptionsPrefix(self._prefix)
        ksp.setOperators(block)
        ksp.setFromOptions()
        ksp.setUp()
        self._rows, self._ksp = rows, ksp
        self._right, self._solution = block.createVecRight(), block.createVecRight()
        self._items = [rows, block, ksp, self._right, self._solution]

    def _stiff(self, part: IntArray, size: int, of_unknowns: FloatArray) -> IntArray:
        """Return the owned unknowns of the stiff nodes of a body, none if they are too many."""
        numbers: IntArray = part.reshape(-1, size)
        # Diagonals of pressures are negative.
        stiffness = of_unknowns[numbers].max(axis=1, initial=0.0)
        softest = float(np.where(stiffness > 0, stiffness, np.inf).min(initial=np.inf))
        stiff = stiffness > STIFF * self._comm.allreduce(softest, op=MPI.MIN)
        counts = size * np.array([np.count_nonzero(stiff), len(stiff)], dtype=np.int64)
        count, all_of_body = self._comm.allreduce(counts, op=MPI.SUM)
        if count > max(CHEAP, min(LARGEST_SHARE * all_of_body, MOST)):
            stiff[:] = False
        found: IntArray = numbers[stiff].ravel()
        return found

    @property
    def exists(self) -> bool:
        """Whether any node is stiff."""
        return bool(self._items)

    def solve(self, b: PETSc.Vec, x: PETSc.Vec, rest: PETSc.Vec) -> None:
        """Set x to the solution of the stiff nodes for b, zero elsewhere, and rest to b - A x."""
        own = self._rows.getIndices() - b.getOwnershipRange()[0]
        self._right.array[:] = b.array_r[own]
        self._ksp.solve(self._right, self._solution)
        x.set(0.0)
        x.array[own] = self._solution.array_r
        assert self._matrix is not None
        self._matrix.mult(x, rest)
        rest.aypx(-1.0, b)

    def _free(self) -> None:
        for item in self._items:
            item.destroy()
        self._items = []

    def destroy(self) -> None:
        """Free the factors."""
        self._free()
