"""Quasi-Newton steps of the passes between heat and mechanics, where pairs follow each other.

Source: J. Degroote, K.-J. Bathe and J. Vierendeels, Performance of a new partitioned procedure
versus a monolithic procedure in fluid-structure interaction, Computers and Structures 87 (2009),
IQN-ILS.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray

COLUMNS = 3
"""Passes before the last one of which a step makes use: those farther back know of other pairs that
were closed."""

INDEPENDENT = 1e-6
"""Part of the largest eigenvalue of the columns' products below which they say the same."""


class _Pass(NamedTuple):
    """Logarithms of the resistances of a pass, and which of them are those of a pair that conducts.

    Attributes:
        found: ln R behind the pass, shape (pairs,).
        residual: ln R behind the pass less ln R before it, likewise.
        conducts: likewise.
    """

    found: FloatArray
    residual: FloatArray
    conducts: BoolArray


class QuasiNewton:
    """Resistances at which the residuals of the last passes, combined, would be least.

    x ← F + Σ α_k ΔF_k with |r + Σ α_k Δr_k| least over all pairs, x = ln R, r = F − x. Logarithms,
    since a pair that touches and one that has left differ by orders of magnitude.

    Args:
        comm: ranks that share the pairs.
    """

    def __init__(self, comm: MPI.Intracomm) -> None:
        self._comm = comm
        self._passes: deque[_Pass] = deque(maxlen=COLUMNS + 1)

    def add(self, tried: FloatArray, found: FloatArray) -> None:
        """Take note of a pass.

        Args:
            tried: resistances with which it began on this rank [m² K/W].
            found: those behind it, likewise.
        """
        conducts = np.isfinite(tried) & np.isfinite(found) & (tried > 0.0) & (found > 0.0)
        before, behind = (np.log(np.where(conducts, R, 1.0)) for R in (tried, found))
        self._passes.append(_Pass(behind, behind - before, conducts))

    def wanted(self) -> FloatArray:
        """Return the next resistances [m² K/W], shape (pairs,); collective.

        They mean nothing for pairs that did not conduct in one of the passes, and are infinite
        where they would overflow.
        """
        counted = np.logical_and.reduce([each.conducts for each in self._passes])
        found = counted * np.array([each.found for each in self._passes])
        residual = counted * np.array([each.residual for each in self._passes])
        of_found, of_residual = found[:-1] - found[-1], residual[:-1] - residual[-1]
        products = np.column_stack([of_residual @ of_residual.T, of_residual @ residual[-1]])
        products = self._comm.allreduce(products, op=MPI.SUM)
        shares = -np.linalg.pinv(products[:, :-1], INDEPENDENT, hermitian=True) @ products[:, -1]
        with np.errstate(over="ignore"):
            return np.asarray(np.exp(found[-1] + shares @ of_found))
