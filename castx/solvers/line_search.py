"""Critical-point line search: shortens Newton steps of a problem that is nearly convex.

Source: P. R. Brune, M. G. Knepley, B. F. Smith and X. Tu, SIAM Review 57 (2015), section 4, "cp".
"""

from __future__ import annotations

from collections.abc import Callable

from petsc4py import PETSc

from scipy.optimize import brentq

ENOUGH = 0.5
"""Part of the first work to which a full step may leave work undone on its way."""

FULL_STEPS = 1
"""Steps taken in full: the first one fulfils all that is linear, constraints and incompressibility,
so that the work of the steps that follow is that of forces alone."""

SHORTEST = 1e-9
"""Part of a step below which none is taken."""

Residual = Callable[[PETSc.SNES, PETSc.Vec, PETSc.Vec], None]


def shorten_step(residual: Residual, x: PETSc.Vec, y: PETSc.Vec, snes: PETSc.SNES) -> bool:
    """Scale a Newton step y to the critical point of the energy on the way from x to x − y.

    There the residual does no work on the step, F(x − λy)·y = 0. A full step that overshoots little
    or not at all is left as it is, so that the last iterations are Newton's.

    Args:
        residual: fills its last argument with F.
        x: present unknowns.
        y: step, changed in place.
        snes: the solver; its residual vector holds F(x).

    Returns:
        Whether the step has changed.
    """
    if snes.getIterationNumber() < FULL_STEPS:
        return False
    trial, force = x.duplicate(), x.duplicate()

    def work(part: float) -> float:
        trial.waxpy(-part, y, x)
        residual(snes, trial, force)
        return float(force.dot(y))

    start, end = float(snes.getFunction()[0].dot(y)), work(1.0)
    shorten = end * start < 0.0 and abs(end) > ENOUGH * abs(start)
    if shorten:
        y.scale(_root(work, start, end))
    for vector in (trial, force):
        vector.destroy()
    return shorten


def _root(work: Callable[[float], float], start: float, end: float) -> float:
    known = {0.0: start, 1.0: end}

    def remembered(part: float) -> float:
        if part not in known:
            known[part] = work(part)
        return known[part]

    # Perfect plasticity has steps of a mechanism, a thousand times too long: not to go at all would
    # repeat them for ever.
    return float(brentq(remembered, 0.0, 1.0, xtol=SHORTEST, rtol=1e-2, disp=False))
