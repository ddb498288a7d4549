"""Inner solver of bodies with mid-sides: a sweep over the nodes of all bodies, between smoothings.

Displacements are linear between the nodes, and bubbles of the edges make them quadratic
(`castx.mechanics.midsides`). Linear motions and bubbles hardly know of each other on any mesh, so
that two levels are enough: with unknowns n of the nodes and m of the mid-sides,

    [ A_n   B  ] [ u_n ]
    [ Bᵀ   A_m ] [ u_m ],     S = A_n − ω B D⁻¹ Bᵀ,     D the diagonal of A_m,

one application is u_m = G r_m, then a sweep of multigrid over the bodies for
S u_n = r_n − B u_m, then u_m = G (r_m − Bᵀ u_n), with G two symmetric sweeps of Gauss-Seidel on the
A_m of each rank.

D⁻¹ is more than A_m⁻¹ where bubbles move together: with all of it S would be indefinite. What
bubbles take of the pressures keeps linear ones stable beside linear displacements, and multigrid
smooths them only if there is more of it.

Source: R. E. Bank, T. F. Dupont and H. Yserentant, Numerische Mathematik 52 (1988), hierarchical
bases; the condensed bubbles of D. N. Arnold, F. Brezzi and M. Fortin, Calcolo 21 (1984).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray
from castx.profiling import RunPart, booked_as
from castx.solvers.inner.nest import Block
from castx.solvers.inner.sweep import BlockSweep

OF_MOTIONS, OF_PRESSURES = 0.5, 4.0
"""ω of displacements, and of pressures with each other."""

SMOOTHINGS = 2
"""Symmetric sweeps of Gauss-Seidel over the mid-sides, before the nodes and behind them."""


class MidsideSchur:
    """Preconditioner of the unknowns of nodes, and behind them on each rank those of mid-sides.

    Args:
        comm: communicator of the matrix.
        prefix: prefix of its PETSc options, which are read when it is first prepared.
        bodies: unknowns of the nodes of each body, by their place among all unknowns.
        pressures: which of the owned unknowns of nodes are pressures, shape (owned of nodes,).
        first: number of the first owned unknown of all.
    """

    def __init__(
        self,
        comm: MPI.Intracomm,
        prefix: str,
        bodies: Sequence[Block],
        pressures: BoolArray,
        first: int,
    ) -> None:
        self.most_changed, self.is_exact = 0, False
        self._comm, self._pressures, self._nodes = comm, pressures, len(pressures)
        before = sum(comm.allgather(self._nodes)[: comm.rank])
        self._sweep = BlockSweep(comm, prefix, [_moved(body, before - first) for body in bodies])
        self.prefix = prefix
        smoother = {
            "ksp_type": "richardson", "ksp_max_it": SMOOTHINGS, "ksp_norm_type": "none",
            "pc_type": "sor",
        }  # fmt: skip
        self.defaults: Mapping[str, object] = {
            **self._sweep.defaults,
            **{f"midsides_{name}": value for name, value in smoother.items()},
        }
        self._smoother = PETSc.KSP().create(comm)
        self._smoother.setOptionsPrefix(f"{prefix}midsides_")
        self._parts: list[PETSc.Mat] = []
        self._work: list[PETSc.Vec] = []

    @booked_as(RunPart.SET_UP)
    def set_up(self, matrix: PETSc.Mat, constrained: BoolArray, anew: bool = False) -> None:
        """Condense the mid-sides into the nodes, and set up the sweep and the smoother."""
        nodes, midsides = self._index_sets(matrix)
        A, B = (matrix.createSubMatrix(nodes, column) for column in (nodes, midsides))
        Bt, Am = (matrix.createSubMatrix(midsides, column) for column in (nodes, midsides))
        for rows in (nodes, midsides):
            rows.destroy()
        self._condense(A, B, Bt, Am)
        self._sweep.set_up(A, constrained[: self._nodes], anew)
        self._smoother.setOperators(Am)
        if not self._work:
            self._smoother.setFromOptions()
            self._work = [A.createVecRight(), A.createVecRight()]
            self._work += [Am.createVecRight() for _ in range(3)]
        self._smoother.setUp()
        for item in self._parts:
            item.destroy()
        self._parts = [A, B, Bt, Am]

    def _index_sets(self, matrix: PETSc.Mat) -> tuple[PETSc.IS, PETSc.IS]:
        start, end = matrix.getOwnershipRange()
        middle = start + self._nodes
        return (
            PETSc.IS().createStride(self._nodes, start, 1, comm=self._comm),
            PETSc.IS().createStride(end - middle, middle, 1, comm=self._comm),
        )

    def _condense(self, A: PETSc.Mat, B: PETSc.Mat, Bt: PETSc.Mat, Am: PETSc.Mat) -> None:
        """Subtract from A the stiffness that the nodes lose by their mid-sides."""
        inverse, scaled = Am.getDiagonal(), Bt.copy()
        inverse.reciprocal()
        scaled.diagonalScale(inverse, None)
        taken = B.matMult(scaled)
        A.axpy(-OF_MOTIONS, taken)
        pressures = A.createVecRight()
        pressures.array[:] = self._pressures
        taken.diagonalScale(pressures, pressures)
        A.axpy(OF_MOTIONS - OF_PRESSURES, taken)
        for item in (inverse, scaled, taken, pressures):
            item.destroy()

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Set x to the result of one application to b."""
        (right, found, own, bubbles, rest), (_, B, Bt, _) = self._work, self._parts
        own.array[:] = b.array_r[self._nodes :]
        self._smoother.solve(own, bubbles)
        B.mult(bubbles, right)
        right.array[:] = b.array_r[: self._nodes] - right.array_r
        self._sweep.solve(right, found)
        Bt.mult(found, rest)
        rest.aypx(-1.0, own)
        self._smoother.solve(rest, bubbles)
        x.array[: self._nodes], x.array[self._nodes :] = found.array_r, bubbles.array_r

    def destroy(self) -> None:
        """Free the sweep, the smoother and the matrices."""
        self._sweep.destroy()
        self._smoother.destroy()
        for item in (*self._parts, *self._work):
            item.destroy()


def _moved(block: Block, by: int) -> Block:
    """Return a block with other numbers of its rows."""
    numbers = (block.rows.getIndices() + by).astype(np.int32)
    rows = PETSc.IS().createGeneral(numbers, comm=block.rows.getComm())
    rows.setBlockSize(block.rows.getBlockSize())
    return block._replace(rows=rows)
