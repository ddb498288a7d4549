"""Inner solver of the arrow-shaped system of bodies and contact multipliers (Chiumenti, section 8).

With one block for each body and contact rows B = ∂(gap)/∂u the system is

    [ A_1           B_1ᵀ ] [ u_1 ]
    [      A_2      B_2ᵀ ] [ u_2 ]
    [ B_1  B_2      C    ] [  λ  ].

Source: M. Benzi, G. H. Golub and J. Liesen, Acta Numerica 14 (2005), section 10.2.
"""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.profiling import RunPart, booked_as
from castx.solvers.inner.entries import diagonal
from castx.solvers.inner.nest import Block
from castx.solvers.inner.sweep import BlockSweep


class ArrowSchur:
    """Schur complement preconditioner of bodies and multipliers, augmented on the closed pairs.

    The block A of the bodies becomes A + BᵀW⁻¹B, a penalty on every closed pair, so that the Schur
    complement is about -W; the right-hand side gets BᵀW⁻¹ times that of the multipliers. A sweep
    over the bodies (block Gauss-Seidel) solves for A, a division by -W for the multipliers.

    Args:
        comm: communicator of the matrix.
        prefix: prefix of its PETSc options, which are read when it is first prepared.
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
        # A pair that closes or opens changes the saddle point: set up anew each time.
        self.most_changed, self.is_exact = 0, False
        self._comm, self._weights = comm, weights
        self._sizes = (sum(body.rows.getLocalSize() for body in bodies), len(weights))
        self._sweep = BlockSweep(comm, prefix, bodies)
        self.prefix, self.defaults = prefix, self._sweep.defaults
        self._schur: FloatArray = -weights
        self._parts: list[PETSc.Mat] = []
        self._work: list[PETSc.Vec] = []

    @booked_as(RunPart.SET_UP)
    def set_up(self, matrix: PETSc.Mat, constrained: BoolArray, anew: bool = False) -> None:
        """Augment the block of the bodies and set up the sweep over them."""
        u, multipliers = self._index_sets(matrix)
        A, Bt = (matrix.createSubMatrix(u, column) for column in (u, multipliers))
        B, C = (matrix.createSubMatrix(multipliers, column) for column in (u, multipliers))
        scaled = self._augment(A, B, Bt)
        self._sweep.set_up(A, constrained[: self._sizes[0]], anew)
        closed = ~constrained[self._sizes[0] :]
        self._schur = np.where(closed, -self._weights, diagonal(C))
        for item in (B, C, *self._parts):
            item.destroy()
        self._parts = [A, Bt, scaled]
        if not self._work:
            self._work = [*(A.createVecRight() for _ in range(3)), Bt.createVecRight()]

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

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Set x to the result of one application to b."""
        (right, found, image, multipliers), (_, Bt, scaled) = self._work, self._parts
        bodies = self._sizes[0]
        multipliers.array[:] = b.array_r[bodies:]
        scaled.mult(multipliers, right)
        multipliers.array[:] /= self._schur
        Bt.mult(multipliers, image)
        right.array[:] += b.array_r[:bodies] - image.array_r
        self._sweep.solve(right, found)
        x.array[:bodies], x.array[bodies:] = found.array_r, multipliers.array_r

    def destroy(self) -> None:
        """Free the sweep and the matrices."""
        self._sweep.destroy()
        for item in (*self._parts, *self._work):
            item.destroy()
