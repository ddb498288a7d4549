"""The fall of feeders in the Jacobian: a block of rank one for each of them.

The level of a feeder falls by all that its nodes supply, and its pressure with it,

    dR = Σ_k c_k (1/A_k) (g_kᵀ dx),   g_k = ∂S_k/∂x,   c_k = ∂R/∂d_k,

so that the block is dense, and is applied without a matrix.
"""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.mechanics.mush.levels import FeederLevels


class SinkingLevels:
    """Applies the block of the sinking levels of one body in its Jacobian.

    Args:
        comm: ranks that share the body.
        levels: of its feeders.
    """

    def __init__(self, comm: MPI.Intracomm, levels: FeederLevels) -> None:
        self._comm, self._levels = comm, levels
        self._forces: list[FloatArray] = []
        self._supplies: list[FloatArray] = []

    @property
    def sinks(self) -> bool:
        """Whether any level can fall; the same on all ranks."""
        return bool(self._levels.per_volume.any())

    def begin(self, forces: Sequence[FloatArray]) -> None:
        """Take the changes c_k of the residual for a fall by a metre, each (owned unknowns,)."""
        self._forces, self._supplies = list(forces), []

    def update(self, supplies: Sequence[FloatArray]) -> None:
        """Take the derivatives g_k of what the feeders supply, each (owned unknowns,)."""
        self._supplies = list(supplies)

    def add_product(self, x: FloatArray, y: FloatArray) -> None:
        """Add the block times owned unknowns x of the body to its rows y; collective."""
        if not self.sinks or not self._supplies:
            return
        here = np.array([supply @ x[: len(supply)] for supply in self._supplies])
        falls = self._comm.allreduce(here, op=MPI.SUM) * self._levels.per_volume
        for force, fall in zip(self._forces, falls, strict=True):
            y[: len(force)] += fall * force
