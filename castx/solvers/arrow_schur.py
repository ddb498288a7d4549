"""Inner solver of the arrow-shaped system of bodies and contact multipliers (Chiumenti, section 8).

With one block for each body and contact rows B = ∂(gap)/∂u the system is

    [ A_1           B_1ᵀ ] [ u_1 ]
    [      A_2      B_2ᵀ ] [ u_2 ]
    [ B_1  B_2      C    ] [  λ  ].

Source: M. Benzi, G. H. Golub and J. Liesen, Acta Numerica 14 (2005), section 10.2.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.profiling import RunPart, booked_as
from castx.solvers.blocks import Block, Blocks, sweep_options


class ArrowSchur:
    """Schur complement preconditioner of bodies and multipliers, augmented on the closed pairs.

    The block A of the bodies becomes A + BᵀW⁻¹B, a penalty on every closed pair, so that the Schur
    complement is about -W; the right-hand side gets BᵀW⁻¹ times that of the multipliers. A sweep
    over the bodies (block Gauss-Seidel) solves for A, a division by -W for the multipliers.

    Args:
        comm: communicator of the matrix.
        prefix: prefix of its PETSc options, which are read at the first set-up.
        bodies: the unknowns of each body.
        weights: W of the owned multipliers, shape (pairs,).
    """

    def __init__(
        self,
        comm: MPI.Intracomm,
        prefix: str,
        bodies: Sequence[Block],
        weights: FloatArray,
    ) -> None:
        options = {f"fieldsplit_bodies_{k}": v for k, v in sweep_options(bodies).items()}
        if len(bodies) > 1:
            # The bodies can be told apart only once PETSc has made their solver.
            options["fieldsplit_bodies_pc_type"] = "none"
        self.defaults: Mapping[str, object] = {
            "ksp_type": "preonly",
            "pc_type": "fieldsplit",
            "pc_fieldsplit_schur_fact_type": "upper",
            "fieldsplit_multipliers_ksp_type": "preonly",
            "fieldsplit_multipliers_pc_type": "jacobi",
        } | options
        # A pair that closes or opens changes the saddle point: set up anew each time.
        self.most_changed, self.is_exact = 0, False
        self._comm, self._weights = comm, weights
        self._sizes = (sum(body.rows.getLocalSize() for body in bodies), len(weights))
        self._blocks = Blocks(comm, bodies)
        self._ksp = PETSc.KSP().create(comm)
        self._ksp.setOptionsPrefix(prefix)
        self.prefix = prefix
        self._outer: PETSc.Mat | None = None
        self._parts: list[PETSc.Mat] = []
        self._work: list[PETSc.Vec] = []

    @booked_as(RunPart.SET_UP)
    def set_up(self, matrix: PETSc.Mat, constrained: BoolArray) -> None:
        """Augment the block of the bodies and set up the split."""
        for item in (self._outer, *self._parts):
            if item is not None:
                item.destroy()
        u, multipliers = self._index_sets(matrix)
        A, Bt = (matrix.createSubMatrix(u, column) for column in (u, multipliers))
        B, C = (matrix.createSubMatrix(multipliers, column) for column in (u, multipliers))
        scaled = self._augment(A, B, Bt)
        nest = self._blocks.update(A, constrained[: self._sizes[0]])
        self._outer = PETSc.Mat().createNest([[nest, Bt], [B, C]], comm=self._comm)
        schur = self._schur_complement(C, constrained)
        first = not self._work
        if first:
            self._work = [A.createVecRight(), C.createVecRight(), matrix.createVecRight()]
        self._parts = [A, B, C, Bt, scaled, schur]
        self._prepare(first, schur)

    def _index_sets(self, matrix: PETSc.Mat) -> tuple[PETSc.IS, PETSc.IS]:
        start, (bodies, multipliers) = matrix.getOwnershipRange()[0], self._sizes
        return (
            PETSc.IS().createStride(bodies, start, 1, comm=self._comm),
            PETSc.IS().createStride(multipliers, start + bodies, 1, comm=self._comm),
        )

    def _augment(self, A: PETSc.Mat, B: PETSc.Mat, Bt: PETSc.Mat) -> PETSc.Mat:
        """Add BᵀW⁻¹B to A; return BᵀW⁻¹."""
        inverse = B.createVecLeft()
        inverse.array[:] = 1.0 / self._weights
        scaled = Bt.copy()
        scaled.diagonalScale(None, inverse)
        product = scaled.matMult(B)
        A.axpy(1.0, product)
        product.destroy()
        inverse.destroy()
        return scaled

    def _schur_complement(self, C: PETSc.Mat, constrained: BoolArray) -> PETSc.Mat:
        diagonal = C.getDiagonal()
        closed = ~constrained[self._sizes[0] :]
        diagonal.array[:] = np.where(closed, -self._weights, diagonal.array_r)
        schur = PETSc.Mat().createDiagonal(diagonal)
        schur.assemble()
        return schur

    def _prepare(self, first: bool, schur: PETSc.Mat) -> None:
        kinds = PETSc.PC.FieldSplitSchurPreType
        self._ksp.setOperators(self._outer)
        pc = self._ksp.pc
        if first:
            assert self._outer is not None
            pc.setType("fieldsplit")
            # Only a Schur split knows about the matrix for its complement.
            pc.setFieldSplitType(PETSc.PC.CompositeType.SCHUR)
            bodies, multipliers = self._outer.getNestISs()[0]
            pc.setFieldSplitIS(("bodies", bodies), ("multipliers", multipliers))
        pc.setFieldSplitSchurPreType(kinds.USER, schur)
        if first:
            self._ksp.setFromOptions()
        self._ksp.setUp()
        if first:
            self._blocks.split(pc.getFieldSplitSchurGetSubKSP()[0].pc)

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Set x to the result of one application to b."""
        u, multiplier, right = self._work
        scaled, bodies = self._parts[4], self._sizes[0]
        right.array[:] = b.array_r
        multiplier.array[:] = b.array_r[bodies:]
        scaled.mult(multiplier, u)
        right.array[:bodies] += u.array_r
        self._ksp.solve(right, x)

    def destroy(self) -> None:
        """Free the hierarchies and blocks."""
        self._ksp.destroy()
        self._blocks.destroy()
        for item in (self._outer, *self._parts, *self._work):
            if item is not None:
                item.destroy()
