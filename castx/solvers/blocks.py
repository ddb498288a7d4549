"""Inner solvers of the mechanics: LU for small systems, block Gauss-Seidel for large ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.profiling import RunPart, booked_as
from castx.solvers.stiff_part import StiffPart

MULTIGRID: Mapping[str, object] = {
    "ksp_type": "preonly",
    "pc_type": "gamg",
    "pc_gamg_threshold": 0.0,
    "pc_gamg_coarse_eq_limit": 1000,
    "pc_gamg_reuse_interpolation": True,
    "mg_levels_ksp_type": "richardson",
    "mg_levels_pc_type": "sor",
}
"""Multigrid of one body, symmetric indefinite where its pressure is an unknown."""


FACTORS: Mapping[str, object] = {
    "ksp_type": "preonly",
    "pc_type": "lu",
    "pc_factor_mat_solver_type": "mumps",
    "mat_mumps_icntl_14": 60,
}
"""Sparse LU factorisation (MUMPS) with room for fill-in."""


def solves_directly(linear: str, unknowns: int, largest: int) -> bool:
    """Return whether linear systems are solved by factors.

    Args:
        linear: "direct", "iterative" or "automatic", by size.
        unknowns: of all ranks.
        largest: number of unknowns up to which "automatic" takes factors.
    """
    return linear == "direct" or (linear == "automatic" and unknowns <= largest)


MOST_CHANGED = 8
"""Gaps that may close or open, each at the price of about one iteration, before a new set-up."""

MOST_CHANGED_IN_SWEEP = 4
"""The same for multigrid: a gap costs some four iterations, a new set-up about a dozen."""


MOST_STIFFENED = 2.0
"""Factor by which the stiffness of an unknown may change before the coarse spaces of multigrid are
built anew: smoothed with that of a liquid they serve no solid, nor a step of another size."""


class DirectSolver:
    """Sparse LU factorisation (MUMPS).

    Args:
        comm: communicator of the matrix.
        prefix: prefix of its PETSc options, which are read at the first set-up.
        most_changed: constrained unknowns that may change before a new factorisation.
    """

    def __init__(self, comm: MPI.Intracomm, prefix: str, most_changed: int = MOST_CHANGED) -> None:
        self.most_changed, self.is_exact = most_changed, True
        self.defaults: Mapping[str, object] = FACTORS
        self._ksp = PETSc.KSP().create(comm)
        self._ksp.setOptionsPrefix(prefix)
        self.prefix = prefix
        self._ready = False

    @booked_as(RunPart.SET_UP)
    def set_up(self, matrix: PETSc.Mat, constrained: BoolArray) -> None:
        """Factorise the matrix."""
        self._ksp.setOperators(matrix)
        if not self._ready:
            self._ksp.setFromOptions()
            self._ready = True
        self._ksp.setUp()

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Set x to the solution for b."""
        self._ksp.solve(b, x)

    def destroy(self) -> None:
        """Free the factors."""
        self._ksp.destroy()


class Block(NamedTuple):
    """Unknowns that one solver solves for, such as those of one body.

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
        self.nest: PETSc.Mat | None = None

    def update(self, matrix: PETSc.Mat, constrained: BoolArray) -> PETSc.Mat:
        """Copy the entries of a matrix; return the nest, or the matrix of the only block."""
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
            self.nest = PETSc.Mat().createNest(self._matrices, comm=self._comm)
        else:
            for row, matrices in zip(self._rows, self._matrices, strict=True):
                for column, block in zip(self._rows, matrices, strict=True):
                    matrix.createSubMatrix(row, column, block)
            if self.nest is None:
                return self._matrices[0][0]
            self.nest.assemble()
        return self.nest

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
        """Return how many constraints of a block and by what factor its stiffness changed."""
        then = self._constrained[b]
        changed = self._comm.allreduce(int(np.count_nonzero(constrained != then)), op=MPI.SUM)
        now, free = diagonal(self._matrices[b][b]), ~constrained & ~then
        return changed, largest_factor(now[free], self._stiffness[b][free], self._comm)

    def _parts(self, constrained: BoolArray) -> list[BoolArray]:
        """Return which unknowns of each block are constrained."""
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


def _by_multigrid(blocks: Sequence[Block]) -> list[PETSc.IS]:
    """Return the rows of blocks that are not solved for exactly."""
    return [block.rows for block in blocks if block.options is not FACTORS]


def sweep_options(blocks: Sequence[Block]) -> dict[str, object]:
    """Return the options of one block Gauss-Seidel sweep, or those of the only block."""
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
        prefix: prefix of its PETSc options, which are read at the first set-up.
        blocks: each unknown is in one of them.
    """

    def __init__(self, comm: MPI.Intracomm, prefix: str, blocks: Sequence[Block]) -> None:
        factors = {f"stiff_{name}": value for name, value in FACTORS.items()}
        self.defaults: Mapping[str, object] = sweep_options(blocks) | factors
        self.is_exact = False
        self._stiff = StiffPart(comm, f"{prefix}stiff_", _by_multigrid(blocks))
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
    def set_up(self, matrix: PETSc.Mat, constrained: BoolArray) -> None:
        """Split the matrix into its blocks and set up their solvers."""
        first = not self._blocks.ready
        assembled = self._blocks.update(matrix, constrained)
        if not first:
            for b in self._blocks.renew_modes(constrained, self.most_changed):
                self._solver_of(b).reset()
        self._ksp.setOperators(assembled)
        if first:
            self._work = [matrix.createVecRight() for _ in range(4)]
            self._blocks.split(self._ksp.pc)
            self._ksp.setFromOptions()
        self._ksp.setUp()
        self._stiff.set_up(matrix, constrained)

    def _solver_of(self, b: int) -> PETSc.KSP:
        several = self._blocks.nest is not None
        return self._ksp.pc.getFieldSplitSubKSP()[b] if several else self._ksp

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Set x to the result of one sweep for b."""
        right, solution, stiff, rest = self._work
        if self._stiff.exists:
            self._stiff.solve(b, stiff, rest)
        own = self._numbers - b.getOwnershipRange()[0]
        right.array[:] = (rest if self._stiff.exists else b).array_r[own]
        self._ksp.solve(right, solution)
        x.array[own] = solution.array_r
        if self._stiff.exists:
            x.axpy(1.0, stiff)

    def destroy(self) -> None:
        """Free the solvers and blocks."""
        self._stiff.destroy()
        self._ksp.destroy()
        self._blocks.destroy()
        for vector in self._work:
            vector.destroy()


class BlockSolver:
    """Solves for one block of a system, where all other unknowns are constrained.

    Args:
        comm: communicator of the matrix.
        prefix: prefix of its PETSc options, which are read at the first set-up.
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
    def set_up(self, matrix: PETSc.Mat, constrained: BoolArray) -> None:
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


def diagonal(matrix: PETSc.Mat) -> FloatArray:
    """Return the owned diagonal of a matrix."""
    vector = matrix.getDiagonal()
    values: FloatArray = vector.array_r.copy()
    vector.destroy()
    return values


def largest_factor(now: FloatArray, then: FloatArray, comm: MPI.Intracomm) -> float:
    """Return the largest factor by which a number has grown or shrunk, on any rank; at least 1.

    Args:
        now: present numbers.
        then: former ones, shape of `now`; zero and other signs are no factor but infinity.
        comm: ranks.
    """
    both = now * then > 0
    ratio = np.divide(now, then, out=np.ones_like(now), where=both)
    factor = np.where(both | (now == then), np.maximum(ratio, 1 / ratio), np.inf)
    return float(comm.allreduce(float(factor.max(initial=1.0)), op=MPI.MAX))


def orthonormal(vectors: Sequence[PETSc.Vec]) -> list[PETSc.Vec]:
    """Orthonormalise vectors in place (Gram-Schmidt, twice); return those that are independent."""
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
