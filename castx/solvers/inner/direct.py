"""Sparse factors of small systems."""

from __future__ import annotations

from collections.abc import Mapping

from mpi4py import MPI
from petsc4py import PETSc

from castx.arrays import BoolArray
from castx.profiling import RunPart, booked_as
from castx.solvers.inner.factors import FactorChoice, forget_failure
from castx.solvers.inner.options import FACTORS
from castx.solvers.inner.whole_matrix import Lacking, WholeMatrix

MOST_CHANGED = 8
"""Gaps that may close or open, each at the price of about one iteration, before new factors."""


class DirectSolver:
    """Sparse factors of the whole matrix (MUMPS).

    Args:
        comm: communicator of the matrix.
        prefix: prefix of its PETSc options, which are read when it is first prepared.
        most_changed: constrained unknowns that may change before a new factorisation.
        lacking: returns what the matrix lacks, see `whole_matrix`.
    """

    def __init__(
        self,
        comm: MPI.Intracomm,
        prefix: str,
        most_changed: int = MOST_CHANGED,
        lacking: Lacking | None = None,
    ) -> None:
        self.most_changed, self.is_exact = most_changed, True
        self.defaults: Mapping[str, object] = FACTORS
        self._ksp = PETSc.KSP().create(comm)
        self._ksp.setOptionsPrefix(prefix)
        self.prefix = prefix
        self._ready, self._whole = False, WholeMatrix(lacking)
        self._factors = FactorChoice()

    @booked_as(RunPart.SET_UP)
    def set_up(self, matrix: PETSc.Mat, constrained: BoolArray, anew: bool = False) -> None:
        """Factorise the matrix."""
        forget_failure(self._ksp)
        self._ksp.setOperators(self._whole.update(matrix, constrained))
        if not self._ready:
            self._ksp.setFromOptions()
            self._ready = True
        self._factors.choose(self._ksp)
        self._ksp.setUp()

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Set x to the solution for b."""
        self._ksp.solve(b, x)

    def destroy(self) -> None:
        """Free the factors."""
        self._ksp.destroy()
        self._whole.destroy()
