"""Equilibrium of all bodies in contact for one step: Newton's method with the active set in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt

from castx.balance import Balance
from castx.contact.active_set import ActiveSet
from castx.errors import ConvergenceError
from castx.line_search import shorten_step
from castx.linear import InnerSolver, SystemPreconditioner, operator_matrix
from castx.snes import NonlinearSolver

FloatArray = npt.NDArray[np.float64]

PREFIX = "castx_mechanics_"
LINEAR_SHARE = 1e-3
"""Part of the nonlinear tolerance to which the linear solves go."""
LOOSEST = 1e-4
"""Part of the residual to which they go at least where bodies flow: those that hardly resist have a
displacement from which no iteration returns behind a residual of 1e-2."""


@dataclass(frozen=True)
class EquilibriumReport:
    """What one equilibrium took.

    Attributes:
        iterations: Newton iterations.
        linear_iterations: iterations of all linear solves.
        contact_changes: pairs that opened or closed, counted each time.
        residuals: residual before each iteration and after the last.
        augmentations: updates of multipliers that are no unknowns, by the number of iterations that
            each followed.
    """

    iterations: int
    linear_iterations: int
    contact_changes: int
    residuals: tuple[float, ...]
    augmentations: tuple[int, ...] = ()


class Equilibrium:
    """Finds displacements, pressures and closed pairs of one step.

    Attributes:
        x: the unknowns of the contact method.
        committed: the owned ones after the last accepted step.

    Args:
        balance: the nonlinear problem.
        inner: solver of the assembled linear system.
        options: PETSc options under `castx_mechanics_`.
    """

    def __init__(self, balance: Balance, inner: InnerSolver, options: Mapping[str, Any]) -> None:
        self._balance, self._inner = balance, inner
        layout, assembly = balance.contact.layout, balance.assembly
        self.x, self._residual_vector = layout.create_vector(), layout.create_vector()
        self.committed: FloatArray = self.x.array_r.copy()
        self._preconditioner = SystemPreconditioner(balance.operator, inner, layout.comm)
        self._matrix = operator_matrix(layout, balance.operator)
        defaults = {"ksp_type": "fgmres", "ksp_max_it": 200, "snes_linesearch_type": "basic",
                    "snes_max_it": 60, "ksp_gmres_restart": 60}
        defaults |= {f"bodies_{name}": value for name, value in inner.defaults.items()}
        self._solver = NonlinearSolver(
            "the mechanical equilibrium", PREFIX, self._residual, self._jacobian,
            vector=self._residual_vector, matrix=self._matrix,
            options={**defaults, **options}, converged=self._converged,
            step_rule=None if assembly.is_linear else partial(shorten_step, self._residual),
        )
        self._solver.snes.ksp.pc.setType("python")
        self._solver.snes.ksp.pc.setPythonContext(self._preconditioner)
        self._linear_tolerance_given = "ksp_rtol" in options
        self._failure, self._new_matrix = "", True
        self._always_fresh, self._was_fresh = False, True
        self._augmentations: list[int] = []

    @property
    def active(self) -> ActiveSet:
        """The closed pairs."""
        return self._balance.active

    def solve(self, time: float) -> EquilibriumReport:
        """Solve for the present state of the bodies, from the present displacements.

        Args:
            time: time of the prescribed displacements and loads [s].

        Raises:
            ConvergenceError: the iteration did not converge.
        """
        self._balance.begin(self.x, time)
        # Elastic constants change little in a step, but freezing multiplies them.
        self._new_matrix = not self._balance.assembly.is_elastic
        start, closed = self.x.array_r.copy(), self.active.closed.copy()
        try:
            return self._try(always_fresh=False)
        except ConvergenceError:
            if self._was_fresh:
                raise
            # An outdated preconditioner may be all that went wrong.
            self.x.array[:], self.active.closed = start, closed
            return self._try(always_fresh=True)

    def _try(self, always_fresh: bool) -> EquilibriumReport:
        self._failure, self._always_fresh, self._was_fresh = "", always_fresh, True
        self.active.begin()
        self._augmentations = []
        try:
            report = self._solver.solve(self.x)
        except ConvergenceError as error:
            text = f"{error}; {self._failure}" if self._failure else str(error)
            raise ConvergenceError(text) from None
        return EquilibriumReport(
            report.iterations, report.linear_iterations, self.active.changes, report.residuals,
            tuple(self._augmentations),
        )

    def _residual(self, _: PETSc.SNES, x: PETSc.Vec, f: PETSc.Vec) -> None:
        try:
            self._balance.residual(x, f)
        except ConvergenceError as error:
            # SNES stops at what is not a number; an exception cannot cross it.
            self._failure = str(error)
            f.set(np.nan)

    def _jacobian(self, snes: PETSc.SNES, x: PETSc.Vec, J: PETSc.Mat, __: PETSc.Mat) -> None:
        renewed = not self._balance.assembly.is_linear and snes.getIterationNumber() > 0
        self._balance.update_matrix(renewed)
        if self._always_fresh or self._new_matrix or (self._inner.is_exact and renewed):
            self._preconditioner.discard()
            self._new_matrix = False
        self._preconditioner.refresh(snes.ksp.getIterationNumber())
        self._was_fresh &= self._preconditioner.is_fresh
        J.assemble()

    def _converged(
        self, snes: PETSc.SNES, iteration: int, norms: tuple[float, float, float]
    ) -> Any:
        reasons, balance = PETSc.SNES.ConvergedReason, self._balance
        if not np.isfinite(norms[2]):
            return reasons.DIVERGED_FNORM_NAN
        x, f = snes.getSolution(), snes.getFunction()[0]
        changed = iteration > 0 and balance.change_set(x, f)
        balanced = balance.holds(f)
        if iteration > 0 and balance.augment(x, f, balanced and not changed):
            self._augmentations.append(iteration)
            balanced = balance.holds(f)
        if balanced and not changed and iteration > 0:
            return reasons.CONVERGED_FNORM_RELATIVE
        if iteration >= snes.getTolerances()[3]:
            return reasons.DIVERGED_MAX_IT
        if not self._linear_tolerance_given:
            snes.ksp.setTolerances(rtol=self._linear_tolerance(f.norm()), atol=0.0)
        return reasons.CONVERGED_ITERATING

    def _linear_tolerance(self, norm: float) -> float:
        """Return to what part of a residual the next linear system is solved.

        Where the next system is another one, what is solved beyond the square of the residual is
        lost, and Newton's method stays quadratic (Dembo, Eisenstat and Steihaug 1982).
        """
        balance = self._balance
        share = LINEAR_SHARE * balance.smallest / norm if norm > 0 else 1e-2
        if not balance.assembly.is_linear and balance.force > 0:
            share = max(share, min(norm / balance.force, LOOSEST))
        return float(np.clip(share, 1e-12, 1e-2))

    def pair_values(self) -> tuple[FloatArray, FloatArray]:
        """Return gaps [m] and contact forces [N] of all rows of this rank, no force where open."""
        return self._balance.pair_values(self.x)

    def support_force(self) -> float:
        """Return the norm of the forces of the supports [N]."""
        return self._balance.support_force(self.x)

    def commit(self) -> None:
        """Make the present solution the one from which the next step starts."""
        self.committed = self.x.array_r.copy()
        self._balance.commit()
        if self._inner.is_exact:  # no step depends on factors of another: no checkpoint has them
            self._preconditioner.discard()

    def rewind(self) -> None:
        """Return to the last committed solution, the displacements of the bodies included."""
        self.x.array[:] = self.committed
        self._balance.rewind(self.x)
        if self._inner.is_exact:
            self._preconditioner.discard()

    def destroy(self) -> None:
        """Free what PETSc holds."""
        self._solver.destroy()
        self._balance.destroy()
        for item in (self._matrix, self._residual_vector, self.x):
            item.destroy()
