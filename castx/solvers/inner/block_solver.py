"""Solver of one block of a system, where all other unknowns are constrained."""

from __future__ import annotations

from collections.abc import Mapping

from mpi4py import MPI
from petsc4py import PETSc

from castx.arrays import BoolArray
from castx.profiling import RunPart, booked_as
from castx.solvers.inner.direct import MOST_CHANGED
from castx.solvers.inner.nest import Block, Blocks
from castx.solvers.inner.options import FACTORS


class BlockSolver:
    """Solves for one block of a system, where all other unknowns are constrained.

    Args:
        comm: communicator of the matrix.
        prefix: prefix of its PETSc options, which are read when it is first prepared.
        block: the unknowns that are not constrained.
    """

    def __init__(self, comm: MPI.Intracomm, prefix: str, block: Block) -> None:
        self.defaults: Mapping[str, object] = block.options
        self.most_changed = MOST_CHANGED
        self.is_exact = block.options is FACTORS
        self._rows, self._blocks = block.rows, Blocks(comm, [block])
        self._ksp = PETSc.KSP().create(comm)
        self._ksp.setOptionsPrefix(prefix)
        self.prefix = prefix

    @booked_as(RunPart.SET_UP)
    def set_up(self, matrix: PETSc.Mat, constrained: BoolArray, anew: bool = False) -> None:
        """Extract the block from the matrix and set up its solver."""
        first = not self._blocks.ready
        self._ksp.setOperators(self._blocks.update(matrix, constrained))
        if first:
            self._ksp.setFromOptions()
        self._ksp.setUp()

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Set x to the approximate solution of the block for b, and to zero elsewhere."""
        x.set(0.0)
        right, solution = b.getSubVector(self._rows), x.getSubVector(self._rows)
        self._ksp.solve(right, solution)
        b.restoreSubVector(self._rows, right)
        x.restoreSubVector(self._rows, solution)

    def destroy(self) -> None:
        """Free the solver and the block."""
        self._ksp.destroy()
        self._blocks.destroy()
