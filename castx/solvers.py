"""Inner solvers of the mechanics: LU for small systems, multigrid by bodies for large ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

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


MOST_CHANGED = 8
"""Gaps that may close or open, each at the price of about one iteration, before a new set-up."""


class DirectSolver:
    """Sparse LU factorisation (MUMPS).

    Args:
        comm: communicator of the matrix.
        prefix: prefix of its PETSc options, which are read at the first set-up.
        most_changed: held unknowns by which a factorisation may fall behind.
    """

    def __init__(self, comm: MPI.Intracomm, prefix: str, most_changed: int = MOST_CHANGED) -> None:
        self.most_changed, self.is_exact = most_changed, True
        self.defaults: Mapping[str, object] = {
            "ksp_type": "preonly",
            "pc_type": "lu",
            "pc_factor_mat_solver_type": "mumps",
            "mat_mumps_icntl_14": 60,
        }
        self._ksp = PETSc.KSP().create(comm)
        self._ksp.setOptionsPrefix(prefix)
        self._ready = False

    def set_up(self, matrix: PETSc.Mat, held: BoolArray) -> None:
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


class BodyBlocks:
    """The blocks of a matrix by bodies as a MatNest, with near-null vectors on its diagonal.

    Args:
        comm: communicator of the matrix.
        parts: owned global indices of each body, with its block size.
        modes: near-null vectors of each body, shape (vectors, owned unknowns of the body).
    """

    def __init__(
        self, comm: MPI.Intracomm, parts: Sequence[PETSc.IS], modes: Sequence[FloatArray]
    ) -> None:
        self._comm, self._parts, self._modes = comm, list(parts), list(modes)
        self._blocks: list[list[PETSc.Mat]] = []
        self.nest: PETSc.Mat | None = None

    def update(self, matrix: PETSc.Mat, held: BoolArray) -> PETSc.Mat:
        """Take over the entries of a matrix; return the nest, or the block of the only body."""
        if not self._blocks:
            self._blocks = [
                [matrix.createSubMatrix(row, column) for column in self._parts]
                for row in self._parts
            ]
            self._attach_modes(held)
            if len(self._parts) == 1:
                return self._blocks[0][0]
            self.nest = PETSc.Mat().createNest(
                self._blocks, isrows=self._parts, iscols=self._parts, comm=self._comm
            )
        else:
            for row, blocks in zip(self._parts, self._blocks, strict=True):
                for column, block in zip(self._parts, blocks, strict=True):
                    matrix.createSubMatrix(row, column, block)
            if self.nest is None:
                return self._blocks[0][0]
            self.nest.assemble()
        return self.nest

    def _attach_modes(self, held: BoolArray) -> None:
        start = 0
        for b, modes in enumerate(self._modes):
            block, size = self._blocks[b][b], modes.shape[1]
            vectors = []
            for mode in modes:
                vector = block.createVecRight()
                vector.array[:] = np.where(held[start : start + size], 0.0, mode)
                vectors.append(vector)
            start += size
            motions = PETSc.NullSpace().create(vectors=orthonormal(vectors), comm=self._comm)
            block.setNearNullSpace(motions)

    @property
    def ready(self) -> bool:
        """Whether the blocks exist."""
        return bool(self._blocks)

    def split(self, pc: PETSc.PC) -> None:
        """Make a PC sweep over the bodies one after the other, if there are several."""
        if self.nest is None:
            return
        pc.setType("fieldsplit")
        pc.setFieldSplitType(PETSc.PC.CompositeType.MULTIPLICATIVE)
        pc.setFieldSplitIS(*((str(b), part) for b, part in enumerate(self.nest.getNestISs()[0])))

    def destroy(self) -> None:
        """Free the blocks."""
        if self.nest is not None:
            self.nest.destroy()
        for block in (block for blocks in self._blocks for block in blocks):
            block.destroy()


def bodywise_options(bodies: int) -> dict[str, object]:
    """Return the options of one multiplicative sweep of multigrid over bodies, or of the one."""
    if bodies == 1:
        return dict(MULTIGRID)
    options: dict[str, object] = {
        "ksp_type": "preonly",
        "pc_type": "fieldsplit",
    }
    for b in range(bodies):
        options |= {f"fieldsplit_{b}_{name}": value for name, value in MULTIGRID.items()}
    return options


class BodywiseMultigrid:
    """One multiplicative sweep over the bodies, each by algebraic multigrid, on a MatNest.

    Args:
        comm: communicator of the matrix.
        prefix: prefix of its PETSc options, which are read at the first set-up.
        parts: owned global indices of each body, with its block size.
        modes: near-null vectors of each body, shape (vectors, owned unknowns of the body).
    """

    def __init__(
        self,
        comm: MPI.Intracomm,
        prefix: str,
        parts: Sequence[PETSc.IS],
        modes: Sequence[FloatArray],
    ) -> None:
        self.defaults: Mapping[str, object] = bodywise_options(len(parts))
        self.most_changed, self.is_exact = MOST_CHANGED, False
        self._blocks = BodyBlocks(comm, parts, modes)
        self._ksp = PETSc.KSP().create(comm)
        self._ksp.setOptionsPrefix(prefix)

    def set_up(self, matrix: PETSc.Mat, held: BoolArray) -> None:
        """Split the matrix into its blocks and build the multigrid hierarchies."""
        first = not self._blocks.ready
        self._ksp.setOperators(self._blocks.update(matrix, held))
        if first:
            self._blocks.split(self._ksp.pc)
            self._ksp.setFromOptions()
        self._ksp.setUp()

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Set x to the result of one sweep for b."""
        self._ksp.solve(b, x)

    def destroy(self) -> None:
        """Free the hierarchies and blocks."""
        self._ksp.destroy()
        self._blocks.destroy()


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
