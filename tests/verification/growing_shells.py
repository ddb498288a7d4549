"""A shell that grows inwards round a core under pressure: sphere and cylinder, exact by increments.

The outside is pressed by P(t) while the front stands at R(t); the core is full and keeps its
volume, so that nothing moves there. What freezes is born free of shear, under the pressure p of the
core. An increment dP thus acts on the shell as it is then (Lamé): du = C r + D r^{1−d} with

    C R + D R^{1−d} = 0,   A C − B D b^{−d} = −dP,   dp = −(A C − B D R^{−d}),

so that D = −C R^d; A = 3 K in the sphere (d = 3) and 2 (K + G/3) in the cylinder in plane strain
(d = 2), B = 2 (d − 1) G, and u(b) and p are sums of increments. Shells that had always been as
thick as in the end would move less, and go back when P does.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from castx.arrays import FloatArray
from tests.verification.closed_shells import COHERENCY, OUTER, YOUNG


class Answer(NamedTuple):
    """Motion of the outside [m] and pressure of the core [Pa] over time, both (times,)."""

    motion: FloatArray
    pressure: FloatArray


def increments(
    dimension: int, poisson: float, front: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return du(b)/dP and dp/dP of shells with their inside at R, shape of R."""
    shear, bulk = YOUNG / (2 * (1 + poisson)), YOUNG / (3 * (1 - 2 * poisson))
    d = dimension
    A, B = (3 * bulk if d == 3 else 2 * (bulk + shear / 3)), 2 * (d - 1) * shear
    C = -1.0 / (A + B * (front / OUTER) ** d)
    motion = C * (OUTER - front**d * OUTER ** (1 - d))
    return np.asarray(motion), np.asarray(-C * (A + B))


def exact(
    dimension: int,
    poisson: float,
    times: FloatArray,
    front: Callable[[FloatArray], FloatArray],
    load: Callable[[FloatArray], FloatArray],
    parts: int = 200,
) -> Answer:
    """Return the answer at increasing times, from rest at the first one.

    Args:
        dimension: 3 for the sphere, 2 for the cylinder.
        poisson: ν.
        times: at which it is wanted, shape (times,).
        front: R over time [m].
        load: P over time [Pa].
        parts: of an interval between times.
    """
    fine = np.interp(np.linspace(0, len(times) - 1, parts * (len(times) - 1) + 1),
                     np.arange(len(times)), times)  # fmt: skip
    change = np.diff(load(fine))
    motion, pressure = increments(dimension, poisson, front(0.5 * (fine[1:] + fine[:-1])))
    sums = [np.concatenate([[0.0], np.cumsum(each * change)])[::parts]
            for each in (motion, pressure)]  # fmt: skip
    return Answer(*sums)


def fraction_behind(x: FloatArray, front: float, size: float) -> FloatArray:
    """Return f_s of an alloy that bears in the part of its control volumes behind the front.

    Args:
        x: places of nodes, (nodes, 2).
        front: R [m].
        size: of the cells [m].
    """
    share = np.clip((np.hypot(x[:, 0], x[:, 1]) - front) / size + 0.5, 0.0, 1.0)
    return np.where(share > 0.0, COHERENCY + (1.0 - COHERENCY) * share, 0.0)
