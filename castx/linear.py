"""Linear systems of the mechanics: held unknowns, floating motions, OSGS, direct and multigrid.

The operator is matrix-free where a matrix would be dense or large: rows of held unknowns are those
of the identity, OSGS adds its projection, supports their springs. The preconditioner eliminates the
held unknowns and the floating motions exactly and leaves the assembled rest to an inner solver.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import ClassVar, Protocol

import numpy as np
import numpy.typing as npt

from mpi4py import MPI
from petsc4py import PETSc

from castx.supports import Support

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
Correction = Callable[[FloatArray, FloatArray], None]
"""Adds to its second argument, owned rows, the image of its first."""


class InnerSolver(Protocol):
    """Approximate or exact inverse of an assembled matrix.

    Attributes:
        defaults: PETSc options without the prefix.
    """

    defaults: ClassVar[Mapping[str, object]]

    def set_up(self, matrix: PETSc.Mat, held: BoolArray) -> None:
        """Prepare for a matrix whose held rows and columns are those of a diagonal."""

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Set x to about the solution for b."""

    def destroy(self) -> None:
        """Free what PETSc holds."""


class SystemOperator:
    """Jacobian of the mechanics as a matrix-free operator, the context of a python Mat.

    Args:
        corrections: what the assembled matrix lacks.
    """

    def __init__(self, corrections: Sequence[Correction]) -> None:
        self.matrix: PETSc.Mat | None = None
        self.held: BoolArray = np.zeros(0, dtype=bool)
        self.stiffness = 1.0
        self.support: Support | None = None
        self._corrections = corrections

    def hold(self, held: BoolArray, stiffness: float, support: Support | None) -> None:
        """Set the unknowns whose rows are `stiffness` times those of the identity."""
        self.held, self.stiffness, self.support = held, stiffness, support

    def free_product(self, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Set y to the product without regard to held unknowns and supports."""
        assert self.matrix is not None
        self.matrix.mult(x, y)
        values = y.array
        for correction in self._corrections:
            correction(x.array_r, values)

    def mult(self, _: PETSc.Mat, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Set y to the product of the Jacobian and x."""
        self.free_product(x, y)
        values, given = y.array, x.array_r
        if self.support is not None:
            values += self.support.force(given)
        values[self.held] = self.stiffness * given[self.held]


class SystemPreconditioner:
    """Eliminates held unknowns and floating motions exactly, the context of a python PC.

    Args:
        operator: the operator to precondition.
        inner: solver of the assembled rest.
    """

    def __init__(self, operator: SystemOperator, inner: InnerSolver) -> None:
        self._operator, self._inner = operator, inner
        self._masked: PETSc.Mat | None = None
        self._work: list[PETSc.Vec] = []

    def refresh(self) -> None:
        """Prepare for the operator as it now is."""
        operator = self._operator
        assert operator.matrix is not None
        if not self._work:
            self._work = [operator.matrix.createVecRight() for _ in range(3)]
        if self._masked is not None:
            self._masked.destroy()
        held = operator.held.copy()
        if operator.support is not None:
            held[operator.support.pins] = True
        self._masked = masked(operator.matrix, held)
        self._inner.set_up(self._masked, held)

    def apply(self, _: PETSc.PC, r: PETSc.Vec, z: PETSc.Vec) -> None:
        """Set z to about the solution of the system for r."""
        operator, (fixed, rest, image) = self._operator, self._work
        held, support = operator.held, operator.support
        fixed.array[:] = np.where(held, r.array_r / operator.stiffness, 0.0)
        operator.free_product(fixed, image)
        rest.array[:] = np.where(held, 0.0, r.array_r - image.array_r)
        if support is not None:
            resultants = support.resultants(rest.array_r)
            rest.array[:] -= resultants @ support.weights
            rest.array[held] = 0.0
            rest.array[support.pins] = 0.0
        self._inner.solve(rest, z)
        values = z.array
        values[held] = fixed.array_r[held]
        if support is not None:
            values[support.pins] = 0.0
            amplitudes = resultants / support.stiffness - support.amplitudes(values)
            values += amplitudes @ support.motions

    def destroy(self, _: PETSc.PC) -> None:
        """Free matrices, vectors and the inner solver; PETSc calls this with its PC."""
        for item in (self._masked, *self._work):
            if item is not None:
                item.destroy()
        self._inner.destroy()


def masked(matrix: PETSc.Mat, held: BoolArray) -> PETSc.Mat:
    """Return a copy in which held rows and columns are those of a diagonal of usual size."""
    copy = matrix.copy()
    keep = copy.createVecRight()
    keep.array[:] = np.where(held, 0.0, 1.0)
    diagonal = copy.getDiagonal()
    comm = copy.getComm().tompi4py()
    sizes = np.abs(diagonal.array_r[~held])
    total = comm.allreduce(np.array([sizes.sum(), float(sizes.size)]), op=MPI.SUM)
    copy.diagonalScale(keep, keep)
    mean = total[0] / total[1] if total[1] else 1.0
    diagonal.array[:] = np.where(held, mean, 0.0)
    copy.setDiagonal(diagonal, addv=PETSc.InsertMode.ADD_VALUES)
    keep.destroy()
    diagonal.destroy()
    return copy


class DirectSolver:
    """Sparse LU factorisation (MUMPS).

    Args:
        comm: communicator of the matrix.
        prefix: prefix of its PETSc options, which are read at the first set-up.
    """

    defaults: ClassVar[Mapping[str, object]] = {
        "ksp_type": "preonly",
        "pc_type": "lu",
        "pc_factor_mat_solver_type": "mumps",
        "mat_mumps_icntl_14": 60,
    }

    def __init__(self, comm: MPI.Comm, prefix: str) -> None:
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
