"""Equilibrium of all bodies in contact for one step: Newton's method with the active set in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
import numpy.typing as npt

from castx.assembly import BodyAssembly
from castx.contact.active_set import ActiveSet
from castx.contact.gaps import Gaps
from castx.contact.system import ContactSystem
from castx.coordinates import Coordinates
from castx.errors import ConvergenceError
from castx.force_balance import ForceBalance
from castx.line_search import shorten_step
from castx.linear import InnerSolver, SystemOperator, SystemPreconditioner, operator_matrix
from castx.snes import NonlinearSolver
from castx.supports import FloatingMotions, Support

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

PREFIX = "castx_mechanics_"
LINEAR_SHARE, NOISE_SHARE = 1e-3, 1e-2
"""Parts of the nonlinear tolerance: to which the linear solves go; that closes or opens pairs."""

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

    Args:
        assembly: residual and matrix of the bodies.
        coordinates: coordinates and prescribed displacements.
        gaps: pairs of all interfaces.
        contact: the contact method.
        inner: solver of the assembled linear system.
        floating: finds what nothing holds; None: no supports.
        tolerance: residual relative to the largest internal, contact or external force.
        options: PETSc options under `castx_mechanics_`.
    """

    def __init__(
        self,
        assembly: BodyAssembly,
        coordinates: Coordinates,
        gaps: Gaps,
        contact: ContactSystem,
        inner: InnerSolver,
        floating: FloatingMotions | None,
        tolerance: float,
        options: Mapping[str, Any],
    ) -> None:
        comm = assembly.layout.comm
        self._assembly, self._coordinates, self.gaps = assembly, coordinates, gaps
        self._contact, self._floating = contact, floating
        self.active = ActiveSet(comm, gaps.initial, gaps.free, gaps.keys())
        self.x = contact.layout.create_vector()
        self._committed, self._committed_time = self.x.array_r.copy(), 0.0
        self._committed_support: Support | None = None
        self._operator = SystemOperator(assembly.corrections())
        self._inner = inner
        self._preconditioner = SystemPreconditioner(self._operator, inner, comm)
        self._matrix = operator_matrix(contact.layout, self._operator)
        self._residual_vector = contact.layout.create_vector()
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
        # Those of pressures are far larger in liquids, since τ is.
        self._displacement_rows = contact.to_unknowns(assembly.displacement_rows()) > 0
        self._linear_tolerance_given = "ksp_rtol" in options
        self._diagonal = np.zeros(0)
        self._stiffness = 0.0
        self._force_balance = ForceBalance(assembly, contact.layout, tolerance)
        self._time, self._failure, self._new_matrix = 0.0, "", True
        self._evaluated: tuple[FloatArray, FloatArray] = np.zeros(0), np.zeros(0)
        self._forces: FloatArray = np.zeros(0)
        self._augmentations: list[int] = []

    def solve(self, time: float) -> EquilibriumReport:
        """Solve for the present state of the bodies, from the present displacements.

        Args:
            time: time of the prescribed displacements and loads [s].

        Raises:
            ConvergenceError: the iteration did not converge.
        """
        self.gaps.set_time(time)
        for body in self._assembly.bodies:
            body.set_time(time)
        self._rows(self.x)
        self._update_matrix()
        # Elastic constants change little in a step, but freezing multiplies them.
        self._new_matrix = not self._assembly.is_elastic
        start, closed = self.x.array_r.copy(), self.active.closed.copy()
        try:
            return self._try(time)
        except ConvergenceError:
            if self._preconditioner.is_fresh:
                raise
            # An outdated preconditioner may be all that went wrong.
            self._preconditioner.discard()
            self.x.array[:], self.active.closed = start, closed
            return self._try(time)

    def _try(self, time: float) -> EquilibriumReport:
        self._time, self._failure = time, ""
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

    def _update_matrix(self) -> None:
        bodies = self._assembly.matrix()
        self._contact.prepare(bodies)
        self._contact.update_bodies(bodies)
        self._operator.matrix = self._contact.matrix(self.active.closed)
        diagonal = self._operator.matrix.getDiagonal()
        self._diagonal = np.abs(diagonal.array_r)
        largest = float(self._diagonal[self._displacement_rows].max(initial=0.0))
        self._stiffness = self._assembly.layout.comm.allreduce(largest, op=MPI.MAX)
        diagonal.destroy()

    def _residual(self, _: PETSc.SNES, x: PETSc.Vec, f: PETSc.Vec) -> None:
        try:
            rows = self._rows(x)
        except ConvergenceError as error:
            # SNES stops at what is not a number; an exception cannot cross it.
            self._failure = str(error)
            f.set(np.nan)
            return
        self._evaluated = x.array_r.copy(), rows.copy()
        self._force_balance.update(x, self._diagonal)
        self._balance(x, rows, f)

    def _balance(self, x: PETSc.Vec, rows: FloatArray, f: PETSc.Vec) -> None:
        """Fill the residual for the present set of closed pairs."""
        closed = self.active.closed
        self._forces = self._trial_forces(x, rows)
        held, violation = self._prescribed(x)
        self._contact.impose(x, self._forces, closed, rows, held, violation)
        support = self._support(held)
        follows = closed.copy() if self._contact.follows_set else closed[:0]
        self._operator.hold(held, self._stiffness, support, follows)
        if support is not None:
            rows += support.force(x.array_r)
        f.array[:] = np.where(held, self._stiffness * violation, rows)

    def _change_set(self, snes: PETSc.SNES) -> bool:
        """Close and open pairs at the present iterate; return whether the residual is a new one.

        A line search tries several points with one set, so this is not done in the residual.
        """
        x, f = snes.getSolution(), snes.getFunction()[0]
        at, rows = self._evaluated
        improved = self._assembly.improve_pressures()
        if improved or not self._all(np.array_equal(at, x.array_r)):
            self._residual(snes, x, f)
            rows = self._evaluated[1]
        if not self.active.update(self._forces, NOISE_SHARE * self._force_balance.smallest):
            return False
        self._balance(x, rows.copy(), f)
        return True

    def _augment(self, snes: PETSc.SNES, iteration: int, balanced: bool) -> bool:
        """Improve the multipliers of the method, if it has any; return whether they changed."""
        if not self._contact.augment(self._forces, self.active.closed, balanced):
            return False
        self._balance(snes.getSolution(), self._evaluated[1].copy(), snes.getFunction()[0])
        self._augmentations.append(iteration)
        return True

    def _trial_forces(self, x: PETSc.Vec, rows: FloatArray) -> FloatArray:
        gaps = self._contact.gaps(x, self._assembly.unknowns)
        return self._contact.trial_forces(x, rows, gaps, self.active.closed, self._stiffness)

    def _all(self, here: bool) -> bool:
        return bool(self._assembly.layout.comm.allreduce(here, op=MPI.LAND))

    def _rows(self, x: PETSc.Vec) -> FloatArray:
        self._contact.displacements(x, self._assembly.unknowns)
        return self._contact.residual(x, self._assembly.residual())

    def _prescribed(self, x: PETSc.Vec) -> tuple[BoolArray, FloatArray]:
        held = np.zeros(self.x.getLocalSize(), dtype=bool)
        violation = np.zeros(len(held))
        for item in self._coordinates.prescribed:
            held[item.local] = True
            violation[item.local] = x.array_r[item.local] - float(item.value(self._time))
        return held, violation

    def _support(self, held: BoolArray) -> Support | None:
        if self._floating is None:
            return None
        values = self._contact.constraint_values(self._floating.motions, self.active.closed)
        return self._floating.find(held, values)

    def _jacobian(self, snes: PETSc.SNES, x: PETSc.Vec, J: PETSc.Mat, __: PETSc.Mat) -> None:
        renewed = not self._assembly.is_linear and snes.getIterationNumber() > 0
        if renewed:
            self._contact.update_bodies(self._assembly.matrix())
        if renewed or self._contact.follows_set:
            self._operator.matrix = self._contact.matrix(self.active.closed)
        if self._inner.is_exact and (renewed or self._new_matrix):
            self._preconditioner.discard()
            self._new_matrix = False
        self._preconditioner.refresh(snes.ksp.getIterationNumber())
        J.assemble()

    def _converged(
        self, snes: PETSc.SNES, iteration: int, norms: tuple[float, float, float]
    ) -> Any:
        reasons = PETSc.SNES.ConvergedReason
        if not np.isfinite(norms[2]):
            return reasons.DIVERGED_FNORM_NAN
        changed = iteration > 0 and self._change_set(snes)
        f, balance = snes.getFunction()[0], self._force_balance
        balanced = balance.holds(f)
        if iteration > 0 and self._augment(snes, iteration, balanced and not changed):
            balanced = balance.holds(f)
        if balanced and not changed and iteration > 0:
            return reasons.CONVERGED_FNORM_RELATIVE
        if iteration >= snes.getTolerances()[3]:
            return reasons.DIVERGED_MAX_IT
        if not self._linear_tolerance_given:
            norm = f.norm()
            share = LINEAR_SHARE * balance.smallest / norm if norm > 0 else 1e-2
            snes.ksp.setTolerances(rtol=float(np.clip(share, 1e-12, 1e-2)), atol=0.0)
        return reasons.CONVERGED_ITERATING

    def pair_values(self) -> tuple[FloatArray, FloatArray]:
        """Return gaps [m] and contact forces [N] of all rows of this rank, no force where open."""
        rows = self._rows(self.x)
        gaps = self._contact.gaps(self.x, self._assembly.unknowns)
        forces = np.where(self.active.closed, self._trial_forces(self.x, rows), 0.0)
        tied = self.gaps.tied
        forces[tied] = rows[self.gaps.local[tied]]
        return gaps, forces

    def support_force(self) -> float:
        """Return the norm of the forces of the supports [N]."""
        support = self._operator.support
        return 0.0 if support is None else support.resultant(self.x.array_r)

    def commit(self) -> None:
        """Make the present solution the one from which the next step starts."""
        self._committed, self._committed_time = self.x.array_r.copy(), self._time
        self._committed_support = self._operator.support
        self.active.commit()
        self._contact.commit()
        for body in self._assembly.bodies:
            body.commit()

    def rewind(self) -> None:
        """Return to the last committed solution, the displacements of the bodies included."""
        self.x.array[:] = self._committed
        self.gaps.set_time(self._committed_time)
        self._operator.support = self._committed_support
        self.active.rewind()
        self._contact.rewind()
        for body in self._assembly.bodies:
            body.rewind()
        self._rows(self.x)

    def destroy(self) -> None:
        """Free what PETSc holds."""
        self._solver.destroy()
        self._contact.destroy()
        self._assembly.destroy()
        for item in (self._matrix, self._residual_vector, self.x):
            item.destroy()
