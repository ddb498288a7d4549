"""Newton's method for the balance of momentum; pairs close and open between iterations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain
from typing import Any

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.domain import compat
from castx.equilibrium.convergence import standstill, worst_row
from castx.equilibrium.forces import MomentumBalance
from castx.equilibrium.linear_system import (
    InnerSolver,
    SelectedPreconditioner,
    SystemPreconditioner,
    operator_matrix,
)
from castx.equilibrium.pair_changes import PairChanges
from castx.errors import ConvergenceError
from castx.solvers.counters import StepCounters
from castx.solvers.diagnosis import MECHANICS
from castx.solvers.line_search import shorten_step
from castx.solvers.snes import NonlinearSolver

PREFIX = "castx_mechanics_"
LINEAR_SHARE = 1e-3
"""Part of the nonlinear tolerance to which the linear solves go."""
EXACT_SHARE = 1e-9
"""The same with factors, by which it costs little: a contact force such as the weight of a body may
be a millionth of the thermal forces, to which the tolerance belongs."""
MOST_WITH_OLD_FACTORS = 30
"""Linear iterations with factors of another set of pairs: where these do not get there they
stagnate far above rounding, and new factors are cheaper."""
LOOSEST = 1e-4
"""Loosest tolerance of the linear solves where bodies flow, relative to the residual and to the
forces in the weakest body, which rows of pairs that close exceed by far. With 1e-2, soft bodies
take displacements from which Newton's method does not recover."""

CHATTERS = (
    "pairs chatter between open and closed, and one of them pulls or penetrates in the state in "
    "which it was left"
)


@dataclass(frozen=True)
class EquilibriumReport:
    """Iterations and residuals of one equilibrium.

    Attributes:
        iterations: Newton iterations.
        linear_iterations: iterations of all linear solves.
        contact_changes: pairs that opened or closed, counted each time.
        residuals: residual of the present set of pairs before each iteration and after the last;
            after an update of multipliers once more.
        augmentations: where in `residuals` updates of multipliers that are no unknowns stand.
        sweeps: where in `residuals` the sweeps over blocks begin.
        balanced: whether the forces balance; a block iteration may stop before they do.
        began_balanced: whether they did but for rounding where the iteration began.
        linear_solves: iterations of each linear solve.
    """

    iterations: int
    linear_iterations: int
    contact_changes: int
    residuals: tuple[float, ...]
    augmentations: tuple[int, ...] = ()
    sweeps: tuple[int, ...] = ()
    balanced: bool = True
    began_balanced: bool = False
    linear_solves: tuple[int, ...] = ()


class Newton:
    """Newton's method for all unknowns, or for some while the others stay where they are.

    Args:
        balance: the nonlinear problem.
        inner: solvers of the assembled linear system, by the unknowns that move; of all if the
            unknowns are None. Of several the next one takes over where one is slow.
        options: PETSc options under `castx_mechanics_`.
        counters: of the step, to which iterations and changes of pairs are added.
    """

    def __init__(
        self,
        balance: MomentumBalance,
        inner: Sequence[tuple[BoolArray | None, Sequence[InnerSolver]]],
        options: Mapping[str, Any],
        counters: StepCounters,
    ) -> None:
        self.balance, self._counters = balance, counters
        self._changes = PairChanges(balance)
        layout = balance.contact.layout
        self._free = [free for free, _ in inner]
        self._preconditioner = SelectedPreconditioner(
            [SystemPreconditioner(balance.operator, solvers, layout.comm) for _, solvers in inner]
        )
        self._vector = layout.create_vector()
        self._matrix = operator_matrix(layout, balance.operator)
        defaults: dict[str, Any] = {
            "ksp_type": "fgmres", "ksp_max_it": 100, "snes_linesearch_type": "basic",
            "snes_max_it": 60, "ksp_gmres_restart": 60, "snes_max_linear_solve_fail": 5,
        }  # fmt: skip
        for solver in chain.from_iterable(solvers for _, solvers in inner):
            name = solver.prefix.removeprefix(PREFIX)
            defaults |= {f"{name}{key}": value for key, value in solver.defaults.items()}
        self._solver = NonlinearSolver(
            MECHANICS, PREFIX, self._residual, self._jacobian,
            vector=self._vector, matrix=self._matrix,
            options={**defaults, **options}, converged=self._change_pairs_and_judge,
            step_rule=self._limit_step,
        )  # fmt: skip
        self._solver.snes.ksp.pc.setType("python")
        self._solver.snes.ksp.pc.setPythonContext(self._preconditioner)
        self._linear_tolerance_given = "ksp_rtol" in options
        self._most_linear = int(self._solver.snes.ksp.getTolerances()[3])
        self._failure = ""
        self._always_fresh, self._was_fresh = False, True
        self._residuals: list[float] = []
        self._augmentations: list[int] = []
        self._linear_solves: list[int] = []

    def begin(self) -> None:
        """Expire preconditioners that do not fit what the balance has begun."""
        # Elastic constants change little in a step, but freezing multiplies them.
        if not self.balance.assembly.is_elastic:
            for preconditioner in self._preconditioner.all:
                preconditioner.expire()

    def solve(self, x: PETSc.Vec, part: int = 0) -> EquilibriumReport:
        """Solve for all unknowns x, or for a part of them.

        Raises:
            ConvergenceError: the iteration did not converge.
        """
        free = self._free[part]
        self.balance.frozen[:] = False if free is None else ~free
        self._preconditioner.chosen = self._preconditioner.all[part]
        start, closed = x.array_r.copy(), self.balance.active.closed.copy()
        try:
            return self._try(x, always_fresh=False)
        except ConvergenceError:
            if self._was_fresh:
                raise
            # An outdated preconditioner may be all that went wrong.
            x.array[:], self.balance.active.closed = start, closed
            return self._try(x, always_fresh=True)
        finally:
            self.balance.frozen[:] = False

    def finish(self, x: PETSc.Vec, time: float) -> EquilibriumReport:
        """Solve for all unknowns: nothing that `solve` returns is left unbalanced."""
        return self.solve(x)

    def _try(self, x: PETSc.Vec, always_fresh: bool) -> EquilibriumReport:
        self._failure, self._always_fresh, self._was_fresh = "", always_fresh, True
        active = self.balance.active
        active.begin()
        self._changes.begin()
        self._residuals, self._augmentations, self._linear_solves = [], [], []
        try:
            report = self._solver.solve(x)
        except ConvergenceError as error:
            limits = self.balance.convergence
            why = self._failure or self._worst_row()
            why += standstill(self._residuals, limits.smallest, limits.tolerance)
            raise ConvergenceError(f"{error}; {why}", MECHANICS) from None
        finally:
            snes = self._solver.snes
            self._counters.mechanics_iterations += snes.getIterationNumber()
            self._counters.linear_iterations += snes.getLinearSolveIterations()
            self._counters.contact_changes += active.changes
        return EquilibriumReport(
            report.iterations,
            report.linear_iterations,
            active.changes,
            tuple(self._residuals),
            tuple(self._augmentations),
            began_balanced=self._residuals[0] <= self.balance.convergence.rounding,
            linear_solves=tuple(self._linear_solves),
        )

    def _worst_row(self) -> str:
        balance = self.balance
        return worst_row(balance.assembly, balance.gaps, balance.contact.layout, self._vector)

    def imbalance(self, x: PETSc.Vec) -> tuple[float, bool]:
        """Return the residual of all unknowns, and whether it is small enough for a set of pairs.

        Pairs close and open.
        """
        self.balance.residual(x, self._vector)
        changed = self._changes.update_pairs(x, self._vector)
        return self._vector.norm(), self.balance.convergence.is_met(self._vector) and not changed

    def _residual(self, _: PETSc.SNES, x: PETSc.Vec, f: PETSc.Vec, *, judged: bool = True) -> None:
        try:
            self.balance.residual(x, f, judged=judged)
        except ConvergenceError as error:
            # SNES stops at what is not a number; an exception cannot cross it.
            self._failure = str(error)
            f.set(np.nan)

    def _jacobian(self, snes: PETSc.SNES, x: PETSc.Vec, J: PETSc.Mat, __: PETSc.Mat) -> None:
        renewed = not self.balance.assembly.is_linear and snes.getIterationNumber() > 0
        self.balance.update_matrix(renewed)
        preconditioner = self._preconditioner.chosen
        if renewed or not self.balance.contact.is_linear:
            preconditioner.renew()
        if self._always_fresh:
            preconditioner.discard()
        preconditioner.refresh(snes.ksp.getIterationNumber())
        self._was_fresh &= preconditioner.is_fresh
        if preconditioner.is_exact:
            old = min(MOST_WITH_OLD_FACTORS, self._most_linear)
            snes.ksp.setTolerances(max_it=self._most_linear if preconditioner.is_fresh else old)
        J.assemble()

    def _limit_step(self, x: PETSc.Vec, y: PETSc.Vec, snes: PETSc.SNES) -> bool:
        """Shorten a step that overshoots or moves a body through another; say whether it did."""
        stopped = self._changes.shorten_to_contact(x, y)
        if self.balance.assembly.is_linear and self.balance.contact.normal.is_linear:
            return stopped
        tried, now = partial(self._residual, judged=False), snes.getFunction()[0].copy()
        if not self.balance.contact.has_friction:  # whose forces are no gradient of an energy
            foretold = self.balance.foretold_rows(y)
            self._changes.foretell(x, y, foretold)
            self.balance.take_off(foretold, now)
            tried = partial(self._without, foretold)
        shortened = shorten_step(tried, x, y, snes, now, self._multipliers)
        now.destroy()
        return self._changes.shorten_overlap(x, y) or shortened or stopped

    def _without(self, foretold: FloatArray, snes: PETSc.SNES, x: PETSc.Vec, f: PETSc.Vec) -> None:
        """Fill the residual, in rows of constrained unknowns without what was foretold there."""
        self._residual(snes, x, f, judged=False)
        self.balance.take_off(foretold, f)

    @property
    def _multipliers(self) -> BoolArray:
        """Unknowns behind those of the bodies, shape (owned,)."""
        found: BoolArray = np.ones(self.balance.contact.layout.size_local, dtype=bool)
        found[: self.balance.assembly.layout.size_local] = False
        return found

    def _change_pairs_and_judge(
        self, snes: PETSc.SNES, iteration: int, norms: tuple[float, float, float]
    ) -> Any:
        """Change the state of the pairs at an iterate, then say whether it is the solution.

        It changes the problem: pairs open, close and slip, multipliers improve, and the residual of
        SNES is filled anew. SNES calls nothing else between the end of a line search and the next
        Jacobian that may do so, and within a line search the problem has to be one function.

        Args:
            snes: the solver.
            iteration: number of the iterate, 0: the first guess.
            norms: of the iterate, of the step and of the residual.

        Returns:
            The reason to stop, or that the iteration goes on.
        """
        reasons, limits = PETSc.SNES.ConvergedReason, self.balance.convergence
        if not np.isfinite(norms[2]):
            return compat.not_finite()
        x, f = snes.getSolution(), snes.getFunction()[0]
        if iteration > 0:
            self._linear_solves.append(snes.ksp.getIterationNumber())
        changed = iteration > 0 and self._changes.update_pairs(x, f)
        self._residuals.append(f.norm())
        balanced = limits.is_met(f)
        if iteration > 0 and self._changes.improve_multipliers(x, f, balanced and not changed):
            self._augmentations.append(len(self._residuals))
            self._residuals.append(f.norm())
            balanced = limits.is_met(f)
        if balanced and not changed and iteration > 0:
            if self._changes.violates():
                self._failure = CHATTERS
                return reasons.DIVERGED_LOCAL_MIN
            return reasons.CONVERGED_FNORM_RELATIVE
        if iteration >= snes.getTolerances()[3]:
            return reasons.DIVERGED_MAX_IT
        if not self._linear_tolerance_given:
            snes.ksp.setTolerances(rtol=self._linear_tolerance(self._residuals[-1]), atol=0.0)
        return reasons.CONVERGED_ITERATING

    def _linear_tolerance(self, norm: float) -> float:
        """Return the relative tolerance of the next linear solve, of a system with this residual.

        Where the next system is another one, what is solved beyond the square of the residual is
        lost, and Newton's method stays quadratic (Dembo, Eisenstat and Steihaug 1982).
        """
        balance, limits = self.balance, self.balance.convergence
        exact = self._preconditioner.chosen.is_exact and balance.is_linear
        wanted = (EXACT_SHARE if exact else LINEAR_SHARE) * limits.smallest
        fills = len(self._residuals) == 1 and balance.assembly.has_pockets  # which are stiff
        if not (balance.is_linear or fills) and limits.weakest > 0:
            wanted = max(wanted, enough_of_linear(norm, limits.weakest))
        return float(np.clip(wanted / norm if norm > 0 else 1e-2, 1e-12, 1e-2))

    def forget(self) -> None:
        """Drop the factors of matrices, which are worth little beside another one."""
        for preconditioner in self._preconditioner.all:
            preconditioner.renew()

    def destroy(self) -> None:
        """Destroy the PETSc objects."""
        self._solver.destroy()
        self._matrix.destroy()
        self._vector.destroy()


def enough_of_linear(norm: float, weakest: float) -> float:
    """Return the residual that a linear solve may leave where the next system is another one [N].

    Args:
        norm: residual of the nonlinear problem [N]. Rows of pairs that have just closed are in it,
            stiffness times penetration, beside which all forces are small.
        weakest: internal forces in the weakest body [N].
    """
    return min(norm**2 / weakest, LOOSEST * min(norm, weakest))
