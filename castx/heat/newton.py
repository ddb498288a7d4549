"""Newton iteration of the heat problem: its PETSc options and the callbacks of SNES."""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

import numpy as np

from castx.domain import compat
from castx.heat.balance import HeatBalance
from castx.heat.solid_feedback import couple_step
from castx.solvers.inner.options import FACTORS, solves_directly
from castx.solvers.line_search import critical_part

PREFIX = "castx_heat_"

FULL_STEPS = 8
"""Newton steps of a solve that are taken in full before `shorten_cycling_step` tries them."""

LARGEST_DIRECT = {2: 100_000, 3: 2_000}
"""Unknowns up to which "automatic" solves directly, by dimension of the mesh.

Measured on a cylinder: in 3-D GMRES is 1.7 times faster at 3200 nodes, 5 times at 13 000; in 2-D
equally fast at 16 000 nodes with steps of 5 s, slower with longer steps.
"""

LINEAR_SHARE = 0.01
"""Part of the imbalance with which Newton's iteration may end that a linear solve leaves."""

FINEST_LINEAR = 1e-9
"""Part of its right-hand side below which no linear solve is asked to go."""

ITERATIVE: dict[str, Any] = {
    "ksp_type": "gmres",
    "ksp_gmres_restart": 100,
    "ksp_rtol": FINEST_LINEAR,
    "pc_type": "bjacobi",
    "sub_pc_type": "ilu",
}
# A search for a smaller residual hurts: a front needs it to grow on its way, see
# `shorten_cycling_step`.
NEWTON: dict[str, Any] = {
    "snes_type": "newtonls",
    "snes_linesearch_type": "basic",
    "snes_max_it": 50,
    "snes_stol": 0.0,
}


def default_options(linear: str, unknowns: int, dimension: int) -> dict[str, Any]:
    """Return the options of a linear solver.

    Args:
        linear: "direct", "iterative" or "automatic", by size.
        unknowns: of the problem.
        dimension: of the mesh.
    """
    direct = solves_directly(linear, unknowns, LARGEST_DIRECT[dimension])
    return NEWTON | dict(FACTORS if direct else ITERATIVE)


def residual(balance: HeatBalance, snes: PETSc.SNES, x: PETSc.Vec, F: PETSc.Vec) -> None:
    """Fill the residual."""
    balance.fill_residual(x, F)


def jacobian(
    balance: HeatBalance, snes: PETSc.SNES, x: PETSc.Vec, J: PETSc.Mat, P: PETSc.Mat
) -> None:
    """Fill the Jacobian."""
    balance.assemble_jacobian(x)


def adjust_step(balance: HeatBalance, x: PETSc.Vec, y: PETSc.Vec, snes: PETSc.SNES) -> bool:
    """Correct the Newton step for solid fractions of whole bodies, then shorten it if it cycles."""
    columns = balance.solid_columns(x)
    if columns:
        couple_step(columns, y, snes.ksp)
    for vector in (vector for column in columns for vector in column):
        vector.destroy()
    return shorten_cycling_step(balance, x, y, snes) or bool(columns)


def shorten_cycling_step(
    balance: HeatBalance, x: PETSc.Vec, y: PETSc.Vec, snes: PETSc.SNES
) -> bool:
    """Shorten the Newton step to its critical point, after some full steps.

    The balances are nearly the gradient of a convex potential of the temperatures. Full steps can
    run in a cycle between melting and solid nodes where the step in time is large; the point at
    which the balances do no work on the change of temperature, F(x − λy)·(T(x − y) − T(x)) = 0,
    ends it. (A smaller norm of the residual is no guide: a moving front needs it to grow.)

    Source: critical-point line search as in P. R. Brune, M. G. Knepley, B. F. Smith, X. Tu, SIAM
    Review 57 (2015), section 4; measured from 10 to 40 000 of α Δt/h².
    """
    if snes.getIterationNumber() < FULL_STEPS:
        return False
    temperature = balance.unknowns.temperature
    change, trial, force = x.duplicate(), x.duplicate(), x.duplicate()

    def work(part: float) -> float:
        trial.waxpy(-part, y, x)
        balance.fill_residual(trial, force)
        return float(force.dot(change))

    balance.evaluate(x)
    start = temperature.array_r.copy()
    trial.waxpy(-1.0, y, x)
    balance.evaluate(trial)
    change.array[:] = temperature.array_r - start
    before = work(0.0)
    part = critical_part(work, before, enough=0.0, precision=1e-9) if before < 0.0 else None
    if part is not None:
        y.scale(part)
    for vector in (change, trial, force):
        vector.destroy()
    return part is not None


def converged(
    balance: HeatBalance,
    tolerance: float,
    inexact: bool,
    snes: PETSc.SNES,
    iteration: int,
    norms: tuple[float, float, float],
) -> PETSc.SNES.ConvergedReason:
    """Compare the residual with the heat that changes place, not with the first residual.

    A residual that is near its goal needs no exact step. Unlike the choices of S. C. Eisenstat and
    H. F. Walker (SIAM J. Sci. Comput. 17, 1996), which follow the decrease of the residual, this
    one costs no iteration of Newton's method, the dearer ones here.

    Args:
        balance: of all bodies, at the last residual.
        tolerance: of the residual, relative to the heat that changes place.
        inexact: whether the next linear solve is only as exact as the goal needs.
        snes: the solver.
        iteration: its number.
        norms: of unknowns, step and residual.
    """
    reasons = PETSc.SNES.ConvergedReason
    if not np.isfinite(norms[2]):
        return compat.not_finite()
    sums = balance.sums()
    allowed = tolerance * sums.moved + sums.rounding
    if sums.residual <= allowed:
        return reasons.CONVERGED_FNORM_ABS
    if inexact:
        share = LINEAR_SHARE * allowed / sums.residual
        snes.ksp.setTolerances(rtol=max(share, FINEST_LINEAR))
    return reasons.ITERATING
