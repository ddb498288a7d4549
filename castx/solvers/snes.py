"""Thin owner of a PETSc SNES: the nonlinear solver of the heat and of the mechanical problem."""

from __future__ import annotations

import gc
import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from petsc4py import PETSc

from castx.errors import CaseError, ConvergenceError
from castx.ranks import end_unless_all_failed

Residual = Callable[[PETSc.SNES, PETSc.Vec, PETSc.Vec], None]
Jacobian = Callable[[PETSc.SNES, PETSc.Vec, PETSc.Mat, PETSc.Mat], None]
ConvergenceTest = Callable[[PETSc.SNES, int, tuple[float, float, float]], Any]
StepRule = Callable[[PETSc.Vec, PETSc.Vec, PETSc.SNES], bool]
Options = Mapping[str, Any]

UNKNOWN_TYPE = 86
"""PETSc's number for the error that a solver of this name does not exist."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class SolveReport:
    """The iterations of a converged solve.

    Attributes:
        iterations: Newton iterations.
        linear_iterations: iterations of all linear solves.
        residuals: 2-norm of the residual before each iteration and after the last.
    """

    iterations: int
    linear_iterations: int
    residuals: tuple[float, ...]


@contextmanager
def collection_paused() -> Iterator[None]:
    """Pause the collector of garbage while what callbacks raise may cross PETSc.

    petsc4py hands it on through C; a collection on that way replaces it, which Python cannot bear:
    the process ends by a fault (exit code 59) about every twentieth time.
    """
    active = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if active:
            gc.enable()


class NonlinearSolver:
    """A SNES with its options.

    The matrix may be of any type; KSP and PC may get Python contexts through `snes` between
    construction and the first solve.

    Args:
        name: the problem in the words of the user, for messages.
        prefix: of all PETSc options of this solver, ends with an underscore.
        residual: fills the residual; a free function or a partial of one.
        jacobian: fills the matrices for the operator and its preconditioner.
        vector: a vector of the layout of the unknown; it holds the residual from now on.
        matrix: operator; the preconditioner is built from it when none is given.
        preconditioner: what the preconditioner is built from.
        options: PETSc options without the prefix; a value of None stands for a bare flag.
        converged: convergence test of the iteration; by default that of PETSc.
        step_rule: may change the Newton step y, after which the line search tries x − y; says
            whether it did.

    Raises:
        CaseError: PETSc does not take an option.
    """

    def __init__(
        self,
        name: str,
        prefix: str,
        residual: Residual,
        jacobian: Jacobian,
        *,
        vector: PETSc.Vec,
        matrix: PETSc.Mat,
        preconditioner: PETSc.Mat | None = None,
        options: Options,
        converged: ConvergenceTest | None = None,
        step_rule: StepRule | None = None,
    ) -> None:
        self.name = name
        self.prefix = prefix
        self.options = dict(options)
        self._verdicts = vector.comm.tompi4py().Dup()
        self.snes = PETSc.SNES().create(vector.comm)
        self.snes.setOptionsPrefix(prefix)
        self.snes.setFunction(residual, vector)
        self.snes.setJacobian(jacobian, matrix, preconditioner or matrix)
        try:
            with self._options_in_database():
                self.snes.setFromOptions()
        except PETSc.Error as error:
            raise self._refusal(error) from error
        if converged is not None:
            self.snes.setConvergenceTest(converged)
        if step_rule is not None:
            self.snes.setLineSearchPreCheck(step_rule, args=(self.snes,))
        self.snes.setConvergenceHistory(reset=True)

    @contextmanager
    def _options_in_database(self) -> Iterator[None]:
        """Keep the options in PETSc's global database only while PETSc may ask for them.

        Inner solvers read theirs when the preconditioner is prepared.
        """
        database = PETSc.Options(self.prefix)
        before = {key: database.getString(key) for key in self.options if database.hasName(key)}
        for key, value in self.options.items():
            database.setValue(key, _as_text(value))
        try:
            yield
        finally:
            for key in self.options:
                database.delValue(key)
            for key, value in before.items():
                database.setValue(key, value)

    def solve(self, x: PETSc.Vec) -> SolveReport:
        """Solve from the first guess in `x` and leave the solution there.

        Raises:
            ConvergenceError: with the reason and the history of the residual; on all ranks.
            CaseError: an inner solver does not exist.
            Exception: what a callback raised.
        """
        try:
            with self._options_in_database(), collection_paused():
                self.snes.solve(None, x)
        except PETSc.Error as error:
            raise self._failure(error) from error
        residuals = tuple(float(value) for value in self.snes.getConvergenceHistory()[0])
        reason = self.snes.getConvergedReason()
        iterations = self.snes.getIterationNumber()
        linear_iterations = self.snes.getLinearSolveIterations()
        if _log.isEnabledFor(logging.DEBUG):
            _log.debug(
                "%s: %s after %d iterations (%d linear), residuals %s",
                self.name, self._reason(reason), iterations, linear_iterations, _texts(residuals),
            )  # fmt: skip
        if reason <= 0:
            raise ConvergenceError(
                f"{self.name} did not converge: {self._reason(reason)} after {iterations} "
                f"iterations, residuals {_ends(residuals)}"
            )
        return SolveReport(iterations, linear_iterations, residuals)

    def solve_linear(self, right: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve the linear system of the matrix as it is now, as exactly as options say.

        Args:
            right: right-hand side.
            x: takes the solution.

        Raises:
            ConvergenceError: PETSc failed; on all ranks.
            Exception: what a callback raised.
        """
        ksp = self.snes.ksp
        try:
            with self._options_in_database(), collection_paused():
                ksp.setOperators(*self.snes.getJacobian()[:2])
                ksp.solve(right, x)
        except PETSc.Error as error:
            raise self._failure(error) from error

    def _failure(self, error: PETSc.Error) -> BaseException:
        """Return the exception to raise for a failure of PETSc, maybe on this rank alone."""
        cause: BaseException = error
        while isinstance(cause, PETSc.Error) and cause.__cause__ is not None:
            cause = cause.__cause__
        if isinstance(cause, PETSc.Error) and cause.ierr == UNKNOWN_TYPE:
            return self._refusal(cause)
        if isinstance(cause, PETSc.Error):  # a factorisation of what is not a number, no memory
            cause = ConvergenceError(f"{self.name} did not converge: PETSc failed: {_last(cause)}")
        if isinstance(cause, ConvergenceError):
            # It leads to another try, for which all ranks are needed.
            end_unless_all_failed(self._verdicts, cause)
        return cause

    def _refusal(self, error: PETSc.Error) -> CaseError:
        """Return the error that names the wrong option."""
        given = ", ".join(f"{key} = {value!r}" for key, value in self.options.items())
        return CaseError(
            f"PETSc does not take an option of {self.name}: {_last(error)}; correct it or leave "
            f"it out in solver.heat or solver.mechanics (in use: {given})"
        )

    def _reason(self, reason: int) -> str:
        text = _reason_text(PETSc.SNES.ConvergedReason, reason)
        if reason != PETSc.SNES.ConvergedReason.DIVERGED_LINEAR_SOLVE:
            return text
        linear = self.snes.ksp.getConvergedReason()
        return f"{text} ({_reason_text(PETSc.KSP.ConvergedReason, linear)})"

    def destroy(self) -> None:
        """Free the SNES; matrices and vectors stay their owner's."""
        self.snes.destroy()
        self._verdicts.Free()


def _last(error: PETSc.Error) -> str:
    """Return the line of PETSc's message that names the fault."""
    return str(error).strip().splitlines()[-1].removeprefix("[0] ")


def _as_text(value: Any) -> str | None:
    """Return an option's value as PETSc reads it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return None if value is None else str(value)


def _reason_text(reasons: type, reason: int) -> str:
    """Return the name of a reason in small letters."""
    names = [name for name, value in vars(reasons).items() if value == reason and name.isupper()]
    return names[0].lower().replace("_", " ") if names else f"reason {reason}"


def _texts(residuals: Sequence[float]) -> str:
    """Return the residuals of an iteration."""
    return ", ".join(f"{value:.3e}" for value in residuals)


def _ends(residuals: Sequence[float]) -> str:
    """Return the residuals of an iteration, of a long one the ends."""
    if len(residuals) <= 8:
        return _texts(residuals)
    return f"{_texts(residuals[:3])}, …, {_texts(residuals[-4:])}"
