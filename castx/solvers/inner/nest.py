"""Blocks of a matrix, such as those of bodies, with the near-null vectors of their multigrid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.solvers.inner.entries import diagonal, largest_factor
from castx.solvers.inner.options import FACTORS

MOST_CHANGED_IN_SWEEP = 4
"""The same for multigrid: a gap costs some four iterations, a new preconditioner a dozen."""


MOST_STIFFENED = 2.0
"""Factor by which the stiffness of an unknown may change before the coarse spaces of multigrid are
built anew: smoothed with that of a liquid they serve no solid, nor a step of another size."""


RESET_UP = 1.1
"""Factor by which the stiffness of an unknown of a block may change before its multigrid is set up
anew with the others: a mould hardly changes while a casting freezes in it."""


class Block(NamedTuple):
    """Block of unknowns of a solver of its own, such as the unknowns of a body.

    Attributes:
        rows: owned global indices, with the block size that all nodes share, if any.
        modes: near-null vectors, shape (vectors, owned unknowns of the block).
        options: of its solver.
    """

    rows: PETSc.IS
    modes: FloatArray
    options: Mapping[str, object]


class Blocks:
    """The blocks of a matrix as a MatNest, with near-null vectors on its diagonal.

    Each rank has its part of the first block, then of the second one, and so on.

    Args:
        comm: communicator of the matrix.
        blocks: each unknown of the nest is in one of them.

    Attributes:
        nest: the MatNest; None for one block.
    """

    def __init__(self, comm: MPI.Intracomm, blocks: Sequence[Block]) -> None:
        self._comm, self._given = comm, list(blocks)
        self._rows = [_listed(block.rows) for block in blocks]
        self._matrices: list[list[PETSc.Mat]] = []
        self._first, self._constrained = 0, list[BoolArray]()
        self._stiffness: list[FloatArray] = []
        self._copied: list[tuple[BoolArray, FloatArray]] = []
        self.nest: PETSc.Mat | None = None

    def update(
        self, matrix: PETSc.Mat, constrained: BoolArray, anew: bool = False
    ) -> PETSc.Mat:
        """Copy the entries of a matrix; return the nest, or the matrix of the only block.

        The diagonal block of a multigrid whose matrix has hardly changed stays as it is, and with
        it its preconditioner, unless all are wanted `anew`.
        """
        if not self._matrices:
            self._matrices = [
                [matrix.createSubMatrix(row, column) for column in self._rows]
                for row in self._rows
            ]
            self._first = matrix.getOwnershipRange()[0]
            self._constrained = self._parts(constrained)
            self._stiffness = [diagonal(self._matrices[b][b]) for b in range(len(self._rows))]
            for b in range(len(self._rows)):
                self._attach_modes(b)
            if len(self._rows) == 1:
                return self._matrices[0][0]
            self._copied = self._present(matrix, constrained)
            self.nest = PETSc.Mat().createNest(self._matrices, comm=self._comm)
            return self.nest
        kept = self._hardly_changed(matrix, constrained, anew)
        for b, (row, matrices) in enumerate(zip(self._rows, self._matrices, strict=True)):
            for c, (column, block) in enumerate(zip(self._rows, matrices, strict=True)):
                if b != c or not kept[b]:
                    matrix.createSubMatrix(row, column, block)
        if self.nest is None:
            return self._matrices[0][0]
        # To assemble the nest would mark all its blocks as changed.
        self.nest.stateIncrease()
        return self.nest

    def _present(
        self, matrix: PETSc.Mat, constrained: BoolArray
    ) -> list[tuple[BoolArray, FloatArray]]:
        """Return constraints and diagonal of each block."""
        values = diagonal(matrix)
        stiffness = [values[rows.getIndices() - self._first] for rows in self._rows]
        return list(zip(self._parts(constrained), stiffness, strict=True))

    def _hardly_changed(
        self, matrix: PETSc.Mat, constrained: BoolArray, anew: bool
    ) -> list[bool]:
        """Return flags of the diagonal blocks that may stay, and store the state of the others."""
        if self.nest is None:
            return [False]
        now, kept = self._present(matrix, constrained), []
        for b, (constraints, stiffness) in enumerate(now):
            then, before = self._copied[b]
            free = ~(constraints | then)
            factor = largest_factor(stiffness[free], before[free], self._comm)
            changed = int(np.count_nonzero(constraints != then))
            changed = self._comm.allreduce(changed, op=MPI.SUM)
            few = changed <= MOST_CHANGED_IN_SWEEP and factor <= RESET_UP
            kept.append(few and not anew and self._given[b].options is not FACTORS)
        for b, stays in enumerate(kept):
            if not stays:
                self._copied[b] = now[b]
        return kept

    @property
    def ready(self) -> bool:
        """Whether the matrices exist."""
        return bool(self._matrices)

    def renew_modes(
        self, constrained: BoolArray, most_changed: int = MOST_CHANGED_IN_SWEEP
    ) -> list[int]:
        """Adapt near-null vectors to constraints; return the blocks whose multigrid is outdated.

        Coarse spaces that were built while a gap was closed lack its motion, and those that were
        smoothed with another stiffness let errors through.

        Args:
            constrained: owned unknowns.
            most_changed: constrained unknowns of a block that may change before it is outdated.
        """
        parts, outdated = self._parts(constrained), []
        for b, now in enumerate(parts):
            changed, factor = self._change(b, now)
            if changed > most_changed or factor > MOST_STIFFENED:
                outdated.append(b)
                self._constrained[b] = now
                self._stiffness[b] = diagonal(self._matrices[b][b])
                self._attach_modes(b)
        return outdated

    def _change(self, b: int, constrained: BoolArray) -> tuple[int, float]:
        """Return the number of changed constraints and the stiffness factor of a block."""
        then = self._constrained[b]
        changed = self._comm.allreduce(int(np.count_nonzero(constrained != then)), op=MPI.SUM)
        now, free = diagonal(self._matrices[b][b]), ~constrained & ~then
        return changed, largest_factor(now[free], self._stiffness[b][free], self._comm)

    def _parts(self, constrained: BoolArray) -> list[BoolArray]:
        """Return masks of the constrained unknowns of each block."""
        return [constrained[rows.getIndices() - self._first] for rows in self._rows]

    def _attach_modes(self, b: int) -> None:
        block, vectors = self._matrices[b][b], []
        for mode in self._given[b].modes:
            vector = block.createVecRight()
            vector.array[:] = np.where(self._constrained[b], 0.0, mode)
            vectors.append(vector)
        if vectors:
            kept = orthonormal(vectors)
            block.setNearNullSpace(PETSc.NullSpace().create(vectors=kept, comm=self._comm))

    def split(self, pc: PETSc.PC) -> None:
        """Let a PC solve block after block (multiplicative field split), if there are several."""
        if self.nest is None:
            return
        pc.setType("fieldsplit")
        pc.setFieldSplitType(PETSc.PC.CompositeType.MULTIPLICATIVE)
        pc.setFieldSplitIS(*((str(b), rows) for b, rows in enumerate(self.nest.getNestISs()[0])))

    def destroy(self) -> None:
        """Free the matrices."""
        if self.nest is not None:
            self.nest.destroy()
        for block in (block for matrices in self._matrices for block in matrices):
            block.destroy()


def _listed(rows: PETSc.IS) -> PETSc.IS:
    """Return the rows as a list: of a range of all rows PETSc makes no copy that it updates."""
    listed = PETSc.IS().createGeneral(rows.getIndices(), comm=rows.getComm())
    listed.setBlockSize(rows.getBlockSize())
    return listed


def orthonormal(vectors: Sequence[PETSc.Vec]) -> list[PETSc.Vec]:
    """Orthonormalise vectors in place (Gram-Schmidt, twice); return the independent ones."""
    kept: list[PETSc.Vec] = []
    for vector in vectors:
        size = vector.norm()
        for _ in range(2):
            for other in kept:
                vector.axpy(-vector.dot(other), other)
        if vector.norm() > 1e-8 * size:
            vector.normalize()
            kept.append(vector)
    return kept
