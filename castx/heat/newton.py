"""Newton iteration of the heat problem: the callbacks that SNES gets."""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

import numpy as np
from scipy.optimize import brentq

from castx.heat.balance import HeatSystem
from castx.heat.solid_feedback import couple_step

FULL_STEPS = 8
"""Newton steps of a solve that are taken in full before `shorten_step` looks at them."""


def residual(system: HeatSystem, snes: PETSc.SNES, x: PETSc.Vec, F: PETSc.Vec) -> None:
    """Fill the residual."""
    system.evaluate(x)
    system.gather_residual(F)


def jacobian(
    system: HeatSystem, snes: PETSc.SNES, x: PETSc.Vec, J: PETSc.Mat, P: PETSc.Mat
) -> None:
    """Fill the Jacobian."""
    system.assemble_jacobian(x)


def adjust_step(system: HeatSystem, x: PETSc.Vec, y: PETSc.Vec, snes: PETSc.SNES) -> bool:
    """Complete the Newton step where interfaces feel a whole body, then shorten it if it cycles."""
    columns = system.solid_columns(x)
    if columns:
        couple_step(columns, y, snes.ksp)
    for vector in (vector for column in columns for vector in column):
        vector.destroy()
    return shorten_step(system, x, y, snes) or bool(columns)


def shorten_step(system: HeatSystem, x: PETSc.Vec, y: PETSc.Vec, snes: PETSc.SNES) -> bool:
    """After some full steps, go to the critical point along the Newton step.

    The balances are nearly the gradient of a convex potential of the temperatures. Full steps can
    run in a cycle between melting and solid nodes where the step in time is large; the point at
    which the balances do no work on the change of temperature, F(x − λy)·(T(x − y) − T(x)) = 0,
    ends it. (A smaller norm of the residual is no guide: a moving front needs it to grow.)

    Source: critical-point line search as in P. R. Brune, M. G. Knepley, B. F. Smith, X. Tu, SIAM
    Review 57 (2015), section 4; measured from 10 to 40 000 of α Δt/h².
    """
    if snes.getIterationNumber() < FULL_STEPS:
        return False
    system.set_unknown(x)
    start = system.temperature.copy()
    change, trial, balance = x.duplicate(), x.duplicate(), x.duplicate()

    def work(part: float) -> float:
        trial.waxpy(-part, y, x)
        system.evaluate(trial)
        system.gather_residual(balance)
        return float(balance.dot(change))

    trial.waxpy(-1.0, y, x)
    system.set_unknown(trial)
    change.array[:] = system.temperature - start
    shorten = work(1.0) > 0.0 > work(0.0)
    if shorten:
        y.scale(brentq(work, 0.0, 1.0, xtol=1e-9, rtol=1e-9, disp=False))
    for vector in (change, trial, balance):
        vector.destroy()
    return shorten


def converged(
    system: HeatSystem,
    tolerance: float,
    snes: PETSc.SNES,
    iteration: int,
    norms: tuple[float, float, float],
) -> Any:
    """Compare the residual with the heat that is moved, not with the first residual."""
    reasons = PETSc.SNES.ConvergedReason
    if not np.isfinite(norms[2]):
        return reasons.DIVERGED_FNORM_NAN
    balance = system.balance()
    if balance.residual <= tolerance * balance.moved + balance.rounding:
        return reasons.CONVERGED_FNORM_ABS
    return reasons.ITERATING
