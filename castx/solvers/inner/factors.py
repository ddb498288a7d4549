"""Which factors a solver takes, and how it forgets factors that failed."""

from __future__ import annotations

from mpi4py import MPI
from petsc4py import PETSc

from castx.solvers.inner.entries import is_symmetric
from castx.solvers.inner.options import FACTORS

PACKAGE = str(FACTORS["pc_factor_mat_solver_type"])
MANY_ROWS, LONG_ROWS = 1_000, 40
"""Rows, and their mean entries, from which on dissection (PORD) is taken, and not least fill as by
MUMPS up to 10,000 rows: in space (60) factors of 6,900 unknowns take 0.115 s for 0.151, and a sixth
less memory; in the plane (20) those of 2,500 take as long, and their analysis three times as long.
Of a small matrix without a zero PORD ends the program.
"""
ORDERING, DISSECTION = 7, 4
"""Numbers of MUMPS for the choice of the ordering, and for the one of PORD."""


class FactorChoice:
    """Lets factors L U be L D Lᵀ, which cost less, until a matrix is not symmetric.

    Another kind of factors, or those of another package, are the choice of a case and stay.
    """

    def __init__(self) -> None:
        self._symmetric = True

    def choose(self, solver: PETSc.KSP) -> None:
        """Choose the factors of a solver; collective.

        Args:
            solver: with its matrix, before it is set up.
        """
        self._symmetric = self._symmetric and is_symmetric(solver.getOperators()[1])
        before, after = ("lu", "cholesky") if self._symmetric else ("cholesky", "lu")
        if solver.pc.getType() == before and solver.pc.getFactorSolverType() == PACKAGE:
            solver.pc.setType(after)
            solver.pc.setFactorSolverType(PACKAGE)
        if solver.pc.getFactorSolverType() == PACKAGE:
            _order(solver)


def _order(solver: PETSc.KSP) -> None:
    """Choose the order of elimination of factors by MUMPS, unless a case has chosen it."""
    matrix = solver.getOperators()[1]
    rows = matrix.getSize()[0]
    entries = matrix.getInfo(PETSc.Mat.InfoType.GLOBAL_SUM)["nz_used"]
    if rows >= MANY_ROWS and entries >= LONG_ROWS * rows:
        solver.pc.setFactorSetUpSolverType()
        solver.pc.getFactorMatrix().setMumpsIcntl(ORDERING, DISSECTION)


def forget_failure(solver: PETSc.KSP) -> None:
    """Let factors that failed be analysed anew: MUMPS goes on with none of them; collective.

    Args:
        solver: by factors, with its matrix or before it has one.
    """
    failed = solver.pc.getFailedReason() != 0
    if solver.getComm().tompi4py().allreduce(failed, op=MPI.LOR):
        matrices = solver.getOperators()
        solver.reset()
        solver.setOperators(*matrices)
