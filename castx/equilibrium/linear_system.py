"""Linear systems of the mechanics: constrained unknowns, floating motions, OSGS.

The operator is matrix-free where a matrix would be dense or large: rows of constrained unknowns are
those of the identity, OSGS adds its projection, supports their springs. The preconditioner
eliminates the constrained unknowns and the floating motions exactly and leaves the assembled rest
to an inner solver.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.equilibrium.supports.springs import SpringSupport
from castx.mechanics.assembly import Correction
from castx.solvers.inner.entries import diagonal, largest_factor
from castx.solvers.layout import Layout

OUTDATED, OUTDATED_BY = 1.5, 4
"""Factor and number of iterations by which a preconditioner may fall behind."""

STIFFENED = 1.5
"""Factor by which the stiffness of an unknown may change before a new preconditioner; beyond
it the extra iterations cost more."""


SLOW = 30
"""Iterations with a preconditioner of the present matrix after which another solver takes over."""


class InnerSolver(Protocol):
    """Approximate or exact inverse of an assembled matrix.

    Attributes:
        prefix: of its PETSc options.
        defaults: PETSc options without the prefix.
        is_exact: whether a new preconditioner pays whenever the matrix is a new one.
    """

    prefix: str
    defaults: Mapping[str, object]
    is_exact: bool

    @property
    def most_changed(self) -> int:
        """Number of constraints and closed pairs that may change before a new preconditioner."""

    def set_up(self, matrix: PETSc.Mat, constrained: BoolArray, anew: bool = False) -> None:
        """Prepare for a matrix whose constrained rows and columns are diagonal.

        Args:
            matrix: the matrix.
            constrained: owned unknowns, shape (owned,).
            anew: whether to keep nothing of an earlier preconditioner.
        """

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Set x to about the solution for b."""

    def destroy(self) -> None:
        """Destroy the PETSc objects."""


class SystemOperator:
    """Jacobian of the mechanics as a matrix-free operator, the context of a python Mat.

    Attributes:
        matrix: the assembled part, contact included.
        constrained: unknowns whose rows are `stiffness` times those of the identity.
        closed: pairs on which the assembled part depends.
        support: springs.

    Args:
        corrections: what the assembled matrix lacks.
    """

    def __init__(self, corrections: Sequence[Correction]) -> None:
        self.matrix: PETSc.Mat | None = None
        self.constrained: BoolArray = np.zeros(0, dtype=bool)
        self.closed: BoolArray = np.zeros(0, dtype=bool)
        self.stiffness = 1.0
        self.support: SpringSupport | None = None
        self._corrections = corrections

    def constrain(
        self,
        constrained: BoolArray,
        stiffness: float,
        support: SpringSupport | None,
        closed: BoolArray,
    ) -> None:
        """Set the constrained unknowns, their diagonal entry, the supports and the closed pairs."""
        self.constrained, self.stiffness, self.support = constrained, stiffness, support
        self.closed = closed

    def free_product(self, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Set y to the product without regard to constrained unknowns and supports."""
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
        values[self.constrained] = self.stiffness * given[self.constrained]


class SystemPreconditioner:
    """Eliminates constrained unknowns and floating motions exactly.

    The inner solver is set up anew only when the matrix has become too different: when many more
    unknowns are constrained or free, or the last solve took many more iterations than the first.
    Where it is slow even so, the next one takes its place for good.

    Args:
        operator: the operator to precondition.
        solvers: of the assembled rest, the one that costs least first.
        comm: ranks.
    """

    def __init__(
        self, operator: SystemOperator, solvers: Sequence[InnerSolver], comm: MPI.Intracomm
    ) -> None:
        self._operator, self._comm = operator, comm
        self._inner, *self._others = solvers
        self._work: list[PETSc.Vec] = []
        self._set_up_for: BoolArray | None = None
        self._masked: PETSc.Mat | None = None
        self._stiffness: FloatArray = np.zeros(0)
        self._first_iterations = 0
        self._anew = self.is_fresh = False

    def refresh(self, iterations: int) -> None:
        """Prepare for the operator as it now is.

        Args:
            iterations: that the last linear solve took.
        """
        operator = self._operator
        assert operator.matrix is not None
        if not self._work:
            self._work = [operator.matrix.createVecRight() for _ in range(3)]
        constrained = operator.constrained.copy()
        if operator.support is not None:
            constrained[operator.support.pins] = True
        state = np.concatenate((constrained, operator.closed))
        if self.is_fresh:
            self._first_iterations = iterations
            if iterations > SLOW and self._others:
                self._inner.destroy()
                self._inner = self._others.pop(0)
                self.discard()
        self.is_fresh = self._is_outdated(state, iterations)
        if self.is_fresh:
            if self._masked is not None:
                self._masked.destroy()
            self._masked = masked(operator.matrix, constrained)
            self._inner.set_up(self._masked, constrained, self._anew)
            self._anew = False
            self._set_up_for, self._stiffness = state, diagonal(operator.matrix)

    def _is_outdated(self, state: BoolArray, iterations: int) -> bool:
        if iterations > OUTDATED * self._first_iterations + OUTDATED_BY:
            self._anew = True
        if self._set_up_for is None or self._anew:
            return True
        changed = int(np.count_nonzero(state != self._set_up_for))
        if int(self._comm.allreduce(changed, op=MPI.SUM)) > self._inner.most_changed:
            return True
        assert self._operator.matrix is not None
        now = diagonal(self._operator.matrix)
        return largest_factor(now, self._stiffness, self._comm) > STIFFENED

    @property
    def is_exact(self) -> bool:
        """Whether the inner solver inverts its matrix exactly."""
        return self._inner.is_exact

    def renew(self) -> None:
        """Take note of a new matrix: an exact inverse of another one is worth little."""
        if self._inner.is_exact:
            self.discard()

    def expire(self) -> None:
        """Mark the preconditioner as outdated for the next `refresh`."""
        self._set_up_for = None

    def discard(self) -> None:
        """Make the next `refresh` set all of the inner solver up anew."""
        self._set_up_for, self._anew = None, True

    def apply(self, r: PETSc.Vec, z: PETSc.Vec) -> None:
        """Set z to about the solution of the system for r."""
        operator, (fixed, rest, image) = self._operator, self._work
        constrained, support = operator.constrained, operator.support
        fixed.array[:] = np.where(constrained, r.array_r / operator.stiffness, 0.0)
        rest.array[:] = np.where(constrained, 0.0, r.array_r)
        if fixed.norm(PETSc.NormType.NORM_INFINITY) > 0:
            operator.free_product(fixed, image)
            rest.array[:] -= np.where(constrained, 0.0, image.array_r)
        if support is not None:
            resultants = support.resultants(rest.array_r)
            rest.array[:] -= resultants @ support.weights
            rest.array[constrained] = 0.0
            rest.array[support.pins] = 0.0
        self._inner.solve(rest, z)
        values = z.array
        values[constrained] = fixed.array_r[constrained]
        if support is not None:
            values[support.pins] = 0.0
            amplitudes = resultants / support.stiffness - support.amplitudes(values)
            values += amplitudes @ support.motions

    def destroy(self) -> None:
        """Free matrices, vectors and the inner solver."""
        for item in (self._masked, *self._work):
            if item is not None:
                item.destroy()
        for solver in (self._inner, *self._others):
            solver.destroy()


class SelectedPreconditioner:
    """One of several preconditioners, the context of a python PC.

    Args:
        preconditioners: among which `chosen` is, at first the first one.
    """

    def __init__(self, preconditioners: Sequence[SystemPreconditioner]) -> None:
        self.all, self.chosen = list(preconditioners), preconditioners[0]

    def apply(self, _: PETSc.PC, r: PETSc.Vec, z: PETSc.Vec) -> None:
        """Set z to about the solution of the system for r."""
        self.chosen.apply(r, z)

    def destroy(self, _: PETSc.PC) -> None:
        """Free all of them; PETSc calls this with its PC."""
        for preconditioner in self.all:
            preconditioner.destroy()


def operator_matrix(layout: Layout, context: SystemOperator) -> PETSc.Mat:
    """Return the python Mat of an operator."""
    sizes = ((layout.size_local, layout.size_global),) * 2
    matrix = PETSc.Mat().createPython(sizes, context, comm=layout.comm)
    matrix.setUp()
    return matrix


def masked(matrix: PETSc.Mat, constrained: BoolArray) -> PETSc.Mat:
    """Return a copy whose constrained rows and columns are diagonal, of usual size."""
    copy = matrix.copy()
    keep = copy.createVecRight()
    keep.array[:] = np.where(constrained, 0.0, 1.0)
    diagonal = copy.getDiagonal()
    comm = copy.getComm().tompi4py()
    sizes = np.abs(diagonal.array_r[~constrained])
    total = comm.allreduce(np.array([sizes.sum(), float(sizes.size)]), op=MPI.SUM)
    copy.diagonalScale(keep, keep)
    mean = total[0] / total[1] if total[1] else 1.0
    diagonal.array[:] = np.where(constrained, mean, 0.0)
    copy.setDiagonal(diagonal, addv=PETSc.InsertMode.ADD_VALUES)
    keep.destroy()
    diagonal.destroy()
    return copy
