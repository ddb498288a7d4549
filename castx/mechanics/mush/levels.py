"""Levels of feeders, which sink by what they supply.

A feeder is a prism whose horizontal area A is that of its surface. Over a step its level falls by

    d = d_n + S/A,

with S the volume that it supplies, in the same step: levels of feeders that communicate agree where
melt flows freely. None runs dry.
"""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray, IntArray
from castx.stateful import Arrays, Saved


class FeederLevels:
    """How far the levels of the feeders of a body have sunk.

    Args:
        comm: ranks that share the body.
        name: of the body.
        names: of its feeders.
        areas: A of the feeders [m²], shape (feeders,); zero: the level stays.
        feeder: number of the feeder of each owned node, −1: none, shape (owned,).

    Attributes:
        drops: d at the start of the step [m], shape (feeders,).
        per_volume: 1/A, zero where the level stays [1/m²], shape (feeders,).
    """

    def __init__(
        self,
        comm: MPI.Intracomm,
        name: str,
        names: Sequence[str],
        areas: FloatArray,
        feeder: IntArray,
    ) -> None:
        self._comm, self._name, self.names = comm, name, tuple(names)
        self._feeder = feeder
        self.per_volume = np.divide(1.0, areas, out=np.zeros_like(areas), where=areas > 0.0)
        self.drops: FloatArray = np.zeros(len(areas))

    def falls(self, supply: FloatArray) -> FloatArray:
        """Return the falls S/A of the levels [m], shape (feeders,); collective.

        Args:
            supply: of the owned nodes [m³], zero where nothing is fed, shape (owned,).
        """
        belongs = self._feeder >= 0
        sums = np.bincount(self._feeder[belongs], supply[belongs], len(self.drops))
        total = self._comm.allreduce(sums.astype(np.float64), op=MPI.SUM)
        return np.asarray(total * self.per_volume)

    def commit(self, supply: FloatArray) -> None:
        """Let the levels sink by an accepted step, argument as above; collective."""
        self.drops = self.drops + self.falls(supply)

    def totals(self) -> dict[str, float]:
        """Return by how much each level has sunk [m], by the name of its column."""
        pairs = zip(self.names, self.drops, strict=True)
        return {f"level_drop.{name}": float(drop) for name, drop in pairs}

    def saved(self) -> dict[str, Saved]:
        """Return the drops of the levels."""
        return {"drops": Saved(self.drops, bodies=(self._name,))}

    def restore(self, arrays: Arrays) -> None:
        """Take it back."""
        self.drops = np.asarray(arrays["drops"], dtype=np.float64).copy()
