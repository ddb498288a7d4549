"""Levels of feeders, which sink by what they supply.

A feeder is a prism whose horizontal area A is that of its surface. Over a step its level falls by

    d = d_n + S/A,

with S the volume that it supplies, in the same step: levels of feeders that communicate agree where
melt flows freely. None runs dry. What the shape loses there follows from S too
(`castx.foundry.pools.pipe`).
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
        supplied: volumes of liquid until then [m³], shape (feeders,).
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
        self.supplied: FloatArray = np.zeros(len(areas))

    def falls(self, supply: FloatArray) -> FloatArray:
        """Return the falls S/A of the levels [m], shape (feeders,); collective.

        Args:
            supply: of the owned nodes [m³], zero where nothing is fed, shape (owned,).
        """
        return np.asarray(self._sums(supply) * self.per_volume)

    def _sums(self, supply: FloatArray) -> FloatArray:
        """Return the supplies of the feeders [m³], (feeders,), argument as above; collective."""
        belongs = self._feeder >= 0
        sums = np.bincount(self._feeder[belongs], supply[belongs], len(self.drops))
        return np.asarray(self._comm.allreduce(sums.astype(np.float64), op=MPI.SUM))

    def commit(self, supply: FloatArray) -> None:
        """Let the levels sink by an accepted step, argument as above; collective."""
        sums = self._sums(supply)
        self.drops = self.drops + sums * self.per_volume
        self.supplied = self.supplied + sums

    def totals(self) -> dict[str, float]:
        """Return the volume supplied [m³] and the fall of the level [m] of each feeder."""
        found = {"fed_volume": self.supplied, "level_drop": self.drops}
        return {
            f"{quantity}.{name}": float(value)
            for quantity, values in found.items()
            for name, value in zip(self.names, values, strict=True)
        }

    def saved(self) -> dict[str, Saved]:
        """Return drops and supplied volumes."""
        found = {"drops": self.drops, "supplied": self.supplied}
        return {name: Saved(values, bodies=(self._name,)) for name, values in found.items()}

    def restore(self, arrays: Arrays) -> None:
        """Take them back."""
        self.drops, self.supplied = (
            np.asarray(arrays[name], dtype=np.float64).copy() for name in ("drops", "supplied")
        )
