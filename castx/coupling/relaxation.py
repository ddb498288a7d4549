"""Acceleration of the passes between heat and mechanics."""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray

AITKEN_BOUNDS = (0.05, 1.5)
PLAIN = 1.0
"""Factor that takes the image under the fixed-point map itself."""
LEAST_SHARE = 0.1
"""An iterate is not relaxed below this share of the smaller of its two last values."""


class Relaxation:
    """Aitken's dynamic relaxation of a fixed-point iteration x ← x + ω (F(x) − x).

    ω_k = −ω_(k−1) r_(k−1)·(r_k − r_(k−1))/|r_k − r_(k−1)|² with the residuals r = F(x) − x (Küttler
    and Wall, Fixed-point fluid-structure interaction solvers with dynamic relaxation, Comput. Mech.
    43, 2008).

    x + ω r with r = found − tried and ω ← −ω r_old·(r − r_old)/‖r − r_old‖², within bounds.

    Args:
        comm: ranks that share the iterates.
    """

    def __init__(self, comm: MPI.Intracomm) -> None:
        self._comm = comm
        self._factor = PLAIN
        self._residual: FloatArray | None = None

    def next(self, tried: FloatArray, found: FloatArray) -> FloatArray:
        """Return the next iterate, which is positive.

        Args:
            tried: the last iterate on this rank.
            found: its image under the fixed-point map.
        """
        finite = np.isfinite(tried) & np.isfinite(found)
        residual = np.where(finite, found, 0.0) - np.where(finite, tried, 0.0)
        if self._residual is not None:
            difference = residual - self._residual
            local = np.array([self._residual @ difference, difference @ difference])
            product, square = self._comm.allreduce(local, op=MPI.SUM)
            if square > 0:
                self._factor = _bounded(-self._factor * product / square)
        self._residual = residual
        relaxed = tried + self._factor * residual
        least = LEAST_SHARE * np.minimum(tried, found)
        return np.where(finite, np.maximum(relaxed, least), found)


def _bounded(factor: float) -> float:
    """Return a factor within its bounds.

    A negative one belongs to a residual that grows in its own direction, as where a skin curls off
    its wall the farther the less heat it loses. Its state lies ahead, and is not to be crept up to.
    """
    return float(np.clip(factor, *AITKEN_BOUNDS)) if factor > 0.0 else PLAIN


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
