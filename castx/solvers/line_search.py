"""Critical-point line search: shortens Newton steps of a problem that is nearly convex.

Source: P. R. Brune, M. G. Knepley, B. F. Smith and X. Tu, SIAM Review 57 (2015), section 4, "cp".
"""

from __future__ import annotations

from collections.abc import Callable

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray

ENOUGH = 0.5
"""Part of the first work to which a full step may leave work undone on its way."""

FULL_STEPS = 1
"""Steps taken in full: the first one fulfils all that is linear, constraints and incompressibility,
so that the work of the steps that follow is that of forces alone."""

SHORTEST = 1e-9
"""Part of a step that is as good as none."""

OVERFLOW = 1e100
"""Stands for a work that is not finite."""

Residual = Callable[[PETSc.SNES, PETSc.Vec, PETSc.Vec], None]


def shorten_step(
    residual: Residual,
    x: PETSc.Vec,
    y: PETSc.Vec,
    snes: PETSc.SNES,
    now: PETSc.Vec,
    at_once: BoolArray,
) -> bool:
    """Scale a Newton step y to the critical point of the energy on the way from x to x − y.

    There the residual does no work on the step, F(x − λy)·y = 0. A full step that overshoots little
    or not at all is left as it is, so that the last iterations are Newton's.

    Args:
        residual: fills its last argument with F.
        x: present unknowns.
        y: step, changed in place.
        snes: the solver.
        now: F(x).
        at_once: owned unknowns that go all the way in any case, such as multipliers: their rows
            are linear and no forces, so that no energy has them as its gradient.

    Returns:
        Whether the step has changed.
    """
    if snes.getIterationNumber() < FULL_STEPS:
        return False
    trial, force, begin, rest = (x.duplicate() for _ in range(4))
    jump = np.where(at_once, y.array_r, 0.0)
    begin.array[:], rest.array[:] = x.array_r - jump, y.array_r - jump

    def work(part: float) -> float:
        trial.waxpy(-part, rest, begin)
        residual(snes, trial, force)
        return float(force.dot(rest))

    jumps = x.getComm().tompi4py().allreduce(bool(jump.any()), op=MPI.LOR)
    start = work(0.0) if jumps else float(now.dot(rest))
    # Perfect plasticity has steps of a mechanism, a thousand times too long: not to go at all would
    # repeat them for ever.
    part = critical_part(work, start, enough=ENOUGH, precision=1e-2)
    if part is not None:
        y.array[:] = jump + part * rest.array_r
    for vector in (trial, force, begin, rest):
        vector.destroy()
    return part is not None


def critical_part(
    work: Callable[[float], float], start: float, *, enough: float, precision: float
) -> float | None:
    """Return the part λ of a step at which the work on it vanishes, work(λ) = 0.

    Args:
        work: of the forces on the step, after a part of it; not finite where they overflow.
        start: work before the step.
        enough: part of the first work to which the full step may leave work of the other sign.
        precision: of λ, relative.

    Returns:
        λ between 0 and 1; None where the full step leaves little work or none of the other sign,
        where the work before it is not finite, or where next to nothing of it would be left: from
        the same place the same step would follow for ever. So it is at a kink, such as that of a
        body that is about to tip onto a pair.
    """
    if not np.isfinite(start):
        return None
    # Where the forces overflow the step has gone too far.
    beyond = -np.copysign(OVERFLOW, start)

    def finite(part: float) -> float:
        found = work(part)
        return found if np.isfinite(found) else float(beyond)

    known = {0.0: start, 1.0: finite(1.0)}
    if known[1.0] * start >= 0.0 or abs(known[1.0]) <= enough * abs(start):
        return None

    def remembered(part: float) -> float:
        if part not in known:
            known[part] = finite(part)
        return known[part]

    from scipy.optimize import brentq  # few runs need it, and it takes long to import

    part = float(brentq(remembered, 0.0, 1.0, xtol=SHORTEST, rtol=precision, disp=False))
    return part if part > SHORTEST else None
