"""Inner solver of large systems: one block Gauss-Seidel sweep, with multigrid for each block."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray
from castx.profiling import RunPart, booked_as
from castx.solvers.inner.factors import FactorChoice, forget_failure
from castx.solvers.inner.nest import MOST_CHANGED_IN_SWEEP, Block, Blocks
from castx.solvers.inner.options import FACTORS
from castx.solvers.inner.stiff_part import StiffPart
from castx.solvers.inner.uncoupled import Uncoupled
from castx.solvers.inner.whole_matrix import Lacking, WholeMatrix


def _by_multigrid(blocks: Sequence[Block]) -> list[PETSc.IS]:
    """Return the rows of blocks that are not solved for exactly."""
    return [block.rows for block in blocks if block.options is not FACTORS]


def sweep_options(blocks: Sequence[Block]) -> dict[str, object]:
    """Return the options of one block Gauss-Seidel sweep, or of the only block."""
    if len(blocks) == 1:
        return dict(blocks[0].options)
    options: dict[str, object] = {"ksp_type": "preonly", "pc_type": "fieldsplit"}
    for b, block in enumerate(blocks):
        options |= {f"fieldsplit_{b}_{name}": value for name, value in block.options.items()}
    return options


class BlockSweep:
    """One block Gauss-Seidel sweep, with a solver for each block, after one for stiff nodes.

    Args:
        comm: communicator of the matrix.
        prefix: prefix of its PETSc options, which are read when it is first prepared.
        blocks: each unknown is in one of them.
        coupling: what unknowns have of those of other blocks, see `uncoupled`.
        lacking: returns what the matrix lacks of blocks that get factors, see `whole_matrix`.
    """

    def __init__(
        self,
        comm: MPI.Intracomm,
        prefix: str,
        blocks: Sequence[Block],
        coupling: PETSc.Mat | None = None,
        lacking: Lacking | None = None,
    ) -> None:
        self._uncoupled = None if coupling is None else Uncoupled(coupling)
        factors = {f"stiff_{name}": value for name, value in FACTORS.items()}
        self.defaults: Mapping[str, object] = sweep_options(blocks) | factors
        self.is_exact = False
        self._whole = None if lacking is None else WholeMatrix(lacking)
        self._stiff = StiffPart(comm, f"{prefix}stiff_", _by_multigrid(blocks))
        self._by_factors = [block.options is FACTORS for block in blocks]
        self._factors = [FactorChoice() for _ in blocks]
        self._blocks = Blocks(comm, blocks)
        self._numbers = np.concatenate([block.rows.getIndices() for block in blocks])
        self._work: list[PETSc.Vec] = []
        self._ksp = PETSc.KSP().create(comm)
        self._ksp.setOptionsPrefix(prefix)
        self.prefix = prefix

    @property
    def most_changed(self) -> int:
        """Constrained unknowns that may change: round stiff nodes one costs tens of iterations."""
        return 0 if self._stiff.exists else MOST_CHANGED_IN_SWEEP

    @booked_as(RunPart.SET_UP)
    def set_up(self, matrix: PETSc.Mat, constrained: BoolArray, anew: bool = False) -> None:
        """Split the matrix into its blocks and set up their solvers."""
        first = not self._blocks.ready
        if self._whole is not None:
            matrix = self._whole.update(matrix, constrained)
        if self._uncoupled is not None:
            matrix = self._uncoupled.set_up(matrix, constrained)
        assembled = self._blocks.update(matrix, constrained, anew)
        if not first:
            for b in self._blocks.renew_modes(constrained):
                if not self._by_factors[b]:  # those are new ones of any new matrix
                    self._solver_of(b).reset()
        self._ksp.setOperators(assembled)
        if first:
            self._work = [matrix.createVecRight() for _ in range(4)]
            self._blocks.split(self._ksp.pc)
            self._ksp.setFromOptions()
        if self._blocks.nest is not None:
            self._ksp.setUp()  # makes the solvers of the blocks
        for b in np.flatnonzero(self._by_factors):
            solver = self._solver_of(int(b))
            forget_failure(solver)
            self._factors[b].choose(solver)
        self._ksp.setUp()
        self._ksp.setUpOnBlocks()
        self._stiff.set_up(matrix, constrained)

    def _solver_of(self, b: int) -> PETSc.KSP:
        several = self._blocks.nest is not None
        return self._ksp.pc.getFieldSplitSubKSP()[b] if several else self._ksp

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Set x to the result of one sweep for b."""
        right, solution, stiff, rest = self._work
        if self._uncoupled is not None:
            b = self._uncoupled.right_hand_side(b)
        if self._stiff.exists:
            self._stiff.solve(b, stiff, rest)
        own = self._numbers - b.getOwnershipRange()[0]
        right.array[:] = (rest if self._stiff.exists else b).array_r[own]
        self._ksp.solve(right, solution)
        x.array[own] = solution.array_r
        if self._stiff.exists:
            x.axpy(1.0, stiff)
        if self._uncoupled is not None:
            self._uncoupled.restore(x)

    def destroy(self) -> None:
        """Free the solvers and blocks."""
        self._stiff.destroy()
        self._ksp.destroy()
        self._blocks.destroy()
        if self._whole is not None:
            self._whole.destroy()
        if self._uncoupled is not None:
            self._uncoupled.destroy()
        for vector in self._work:
            vector.destroy()
