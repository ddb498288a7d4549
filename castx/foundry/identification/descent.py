"""Levenberg and Marquardt's descent within bounds, for models of which each evaluation is a run.

Sources: K. Levenberg, Q. Appl. Math. 2 (1944) 164-168, D. W. Marquardt, SIAM J. Appl. Math. 11
(1963) 431-441; the damping by the gain ratio is that of H. B. Nielsen, report IMM-REP-1999-05,
Technical University of Denmark (1999).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear

from castx.arrays import FloatArray
from castx.errors import ConvergenceError

Residuals = Callable[[FloatArray], FloatArray]
"""Roots of the terms of 2 Φ at a point; infinite ones are refused."""
Slopes = Callable[[FloatArray], FloatArray]
"""Their derivatives, (residuals, parameters)."""
FIRST_DAMPING = 1e-3
LEAST_DAMPING = 1e-9
LEAST_GAIN = 1e-4
SETTLED = 0.02
"""Step, in posterior deviations, below which a descent has settled."""


@dataclass(frozen=True, eq=False)
class Descended:
    """The end of a descent.

    Attributes:
        point: (parameters,).
        slopes: there, (residuals, parameters).
    """

    point: FloatArray
    slopes: FloatArray


def descend(
    residuals: Residuals,
    slopes: Slopes,
    first: FloatArray,
    bounds: tuple[FloatArray, FloatArray],
    tries: int,
    reach: FloatArray | float = np.inf,
) -> Descended:
    """Lower Φ until the next full step is less than 2 % of each posterior deviation.

    It ends as well where only steps of that size would lower Φ: what is left is then below what the
    model resolves.

    Args:
        residuals: of a point.
        slopes: of a point.
        first: where it begins, (parameters,).
        bounds: smallest and largest point, (parameters,) each.
        tries: how many points at most, refused ones too.
        reach: largest step of each parameter.

    Raises:
        ConvergenceError: it has not settled.
        ValueError: the slopes do not tell all parameters apart.
    """
    point, damping, growth = first, FIRST_DAMPING, 2.0
    miss = residuals(point)
    for _ in range(tries):
        matrix = slopes(point)
        curvature, gradient = matrix.T @ matrix, matrix.T @ miss
        limit = SETTLED * _deviations(curvature)
        room = bounds[0] - point, bounds[1] - point
        near = np.maximum(room[0], -reach), np.minimum(room[1], reach)
        if np.all(np.abs(bounded_step(curvature, gradient, room)) < limit):
            return Descended(point, matrix)
        while tries > 0:
            tries -= 1
            damped = curvature + damping * np.diag(np.diag(curvature))
            step = bounded_step(damped, gradient, near)
            there = residuals(point + step)
            foreseen = -float(2.0 * gradient @ step + step @ curvature @ step)
            gained = float(miss @ miss - there @ there)
            gain = gained / foreseen if foreseen > 0.0 else -1.0
            if np.isfinite(gain) and gain > LEAST_GAIN:
                point, miss = point + step, there
                shrunk = damping * max(1.0 / 3.0, 1.0 - (2.0 * gain - 1.0) ** 3)
                damping, growth = max(LEAST_DAMPING, shrunk), 2.0
                break
            if np.all(np.abs(step) < limit):
                return Descended(point, matrix)
            damping, growth = damping * growth, 2.0 * growth
    raise ConvergenceError("the descent has not settled")


def _deviations(curvature: FloatArray) -> FloatArray:
    if np.linalg.matrix_rank(curvature) < len(curvature):
        raise ValueError("the samples do not tell all parameters apart")
    return np.asarray(np.sqrt(np.diag(np.linalg.inv(curvature))))


def bounded_step(
    curvature: FloatArray, gradient: FloatArray, room: tuple[FloatArray, FloatArray]
) -> FloatArray:
    """Return the step to the least of a quadratic form within bounds.

    Args:
        curvature: H of ½ Δᵀ H Δ + gᵀ Δ, (parameters, parameters), positive definite.
        gradient: g, (parameters,).
        room: steps to the lower and to the upper bounds, (parameters,) each.
    """
    low, high = room
    free = -np.linalg.solve(curvature, gradient)
    if np.all((free >= low) & (free <= high)):
        return np.asarray(free)
    scale = np.sqrt(np.diag(curvature))
    root = np.linalg.cholesky(curvature / np.outer(scale, scale))
    target = -np.linalg.solve(root, gradient / scale)
    found = lsq_linear(root.T, target, (low * scale, high * scale), method="bvls")
    return np.asarray(np.clip(found.x / scale, low, high))
