"""Acceleration of the passes between heat and mechanics."""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.coupling.quasi_newton import QuasiNewton

AITKEN_BOUNDS = (0.05, 1.5)
PLAIN = 1.0
"""Factor that takes the image under the fixed-point map itself."""
ROUND, PROGRESS = 6, 0.5
"""Passes in which the least change has to fall to this share of the least one before."""
LEAST_SHARE = 0.1
"""An iterate is not relaxed below this share of the smaller of its two last values."""
ALONE = 5
"""Passes in which each pair follows itself alone; from then on they are foreseen together."""


class Relaxation:
    """Aitken's relaxation of a fixed-point iteration x ← x + ω (F(x) − x), a factor for each pair.

    The gap of a pair follows its own heat far more than that of the others, and one pair may open
    where another closes. A factor that all share (Küttler and Wall, Fixed-point fluid-structure
    interaction solvers with dynamic relaxation, Comput. Mech. 43, 2008) serves neither of them: it
    takes a fourth more passes where a feeder curls off its chill.

    x + ω r with r = found − tried and ω ← −ω r_old/(r − r_old), within bounds.

    Where a few pairs hang on the heat of each other, as in coarse castings at a good wall, that
    goes round. Steps that have not come to an end after some passes go on by quasi-Newton steps.

    Args:
        comm: ranks that share the pairs.
    """

    def __init__(self, comm: MPI.Intracomm) -> None:
        self._factor: FloatArray | float = PLAIN
        self._residual: FloatArray | None = None
        self._together, self._passes = QuasiNewton(comm), 0

    def next(self, tried: FloatArray, found: FloatArray) -> FloatArray:
        """Return the next iterate, which is positive; collective.

        Args:
            tried: the last iterate on this rank.
            found: its image under the fixed-point map.
        """
        finite = np.isfinite(tried) & np.isfinite(found)
        residual = np.where(finite, found, 0.0) - np.where(finite, tried, 0.0)
        if self._residual is not None:
            self._factor = _secant(self._factor, self._residual, residual)
        self._residual = residual
        self._together.add(tried, found)
        self._passes += 1
        relaxed = tried + self._factor * residual
        if self._passes > ALONE:
            relaxed = np.minimum(self._together.wanted(), np.maximum(tried, found) / LEAST_SHARE)
        least = LEAST_SHARE * np.minimum(tried, found)
        return np.where(finite, np.maximum(relaxed, least), found)


def _secant(factor: FloatArray | float, before: FloatArray, residual: FloatArray) -> FloatArray:
    """Return the factors with which residuals would vanish if they were linear, within bounds.

    A negative one belongs to a residual that grows in its own direction, as where a skin curls off
    its wall the farther the less heat it loses. Its state lies ahead, and is not to be crept up to.
    """
    change = residual - before
    moved = change != 0.0
    found = np.divide(-factor * before, change, out=np.full(len(residual), PLAIN), where=moved)
    return np.where(found > 0.0, np.clip(found, *AITKEN_BOUNDS), PLAIN)


def goes_round(changes: Sequence[float]) -> bool:
    """Return whether passes no longer come closer to each other: a smaller step does.

    Args:
        changes: of all passes so far, the same on all ranks.
    """
    if len(changes) < 2 * ROUND:
        return False
    return min(changes[-ROUND:]) > PROGRESS * min(changes[:-ROUND])


def scaling(resistances: Sequence[FloatArray], wanted: FloatArray) -> list[FloatArray]:
    """Return the ratios of wanted to present resistances.

    Args:
        resistances: of the pairs of each interface [m² K/W].
        wanted: those of all interfaces one after the other [m² K/W].

    Returns:
        For each interface factors of shape (pairs,), one where a resistance is zero or infinite.
    """
    found, begin = [], 0
    for own in resistances:
        aim = wanted[begin : begin + len(own)]
        begin += len(own)
        finite = np.isfinite(own) & np.isfinite(aim) & (own > 0.0)
        found.append(np.divide(aim, own, out=np.ones(len(own)), where=finite))
    return found
