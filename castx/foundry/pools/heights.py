"""Heights of the nodes of a body along gravity, and the highest places of its pools."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray, IntArray, LongArray

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh

SAME_HEIGHT = 1e-9
"""Difference of heights, beside the extent of a body, that counts as none."""


@dataclass(frozen=True, eq=False)
class Places:
    """The highest places of a pool on all ranks, the highest first; a place is one height.

    Attributes:
        keys: whole numbers of the heights, (places,).
        heights: (places,) [m].
        liquid: volume there when a step begins, (places,) [m³].
        freezing: how much of it freezes in the step if none flows out, (places,) [m³].
    """

    keys: LongArray
    heights: FloatArray
    liquid: FloatArray
    freezing: FloatArray

    @classmethod
    def of(cls, rows: FloatArray, pool: int) -> Self:
        """Return the places of a pool from the rows of all ranks, see `Heights.highest`."""
        _, key, height, liquid, freezing = rows[rows[:, 0] == pool].T
        downward, first, which = np.unique(-key, return_index=True, return_inverse=True)
        volumes = np.zeros((2, len(first)))
        np.add.at(volumes.T, which.ravel(), np.column_stack([liquid, freezing]))
        return cls(-downward.astype(np.int64), height[first], volumes[0], volumes[1])

    def among(self, nodes: LongArray, keys: LongArray) -> tuple[LongArray, LongArray]:
        """Return the given nodes that lie in a highest place, and the number of their place.

        Args:
            nodes: of the pool, (nodes,).
            keys: of their heights, (nodes,).
        """
        place = np.searchsorted(-self.keys, -keys)
        inside = place < len(self.keys)
        nodes, place, keys = nodes[inside], place[inside], keys[inside]
        same = self.keys[place] == keys
        return nodes[same], place[same]

    def level(self, left: FloatArray, level: float) -> float:
        """Return the level after a step [m]; a place reaches down to the middle of the next one.

        Args:
            left: share of the liquid that has not flowed out of each place, (places,).
            level: before the step [m].
        """
        following = np.append(self.heights[1:], self.heights[-1:])
        for share, floor in zip(left, 0.5 * (self.heights + following), strict=True):
            if share >= 1.0:
                break
            level = float(floor + (level - floor) * share)
        return level


class Heights:
    """Heights of the nodes of a body along gravity.

    Attributes:
        values: of the local nodes, (nodes,) [m].
        keys: whole numbers of the heights, equal for nodes of one height, (nodes,).

    Args:
        body: its mesh.
        up: direction against gravity, of length 1.
    """

    def __init__(self, body: BodyMesh, up: Sequence[float]) -> None:
        self._comm: MPI.Intracomm = body.mesh.comm
        self.values: FloatArray = body.points @ np.array(up)
        ends = self.values.min(initial=np.inf), self.values.max(initial=-np.inf)
        every = np.array(self._comm.allgather(ends))
        self._low = float(every[:, 0].min())
        self._unit = SAME_HEIGHT * (float(every[:, 1].max()) - self._low)
        self.keys: LongArray = np.rint((self.values - self._low) / self._unit).astype(np.int64)

    def highest(
        self, pool: IntArray, liquid: FloatArray, freezing: FloatArray, lacking: FloatArray
    ) -> FloatArray:
        """Return the highest places of all pools on all ranks; collective.

        Those of each rank that hold what the pool lacks, and the next one below: they are among the
        highest of all ranks.

        Args:
            pool: of the owned nodes, -1: none, (owned,).
            liquid: volume at these nodes when the step begins, (owned,) [m³].
            freezing: how much of it freezes in the step if none flows out, (owned,) [m³].
            lacking: what each pool lacks at most, (pools,) [m³].

        Returns:
            Rows of pool, key of the height, height, liquid and freezing volume, (places, 5).
        """
        rows: list[FloatArray] = [np.zeros((0, 5))]
        for number, lack in enumerate(lacking):
            here = np.flatnonzero(pool == number)
            downward, which = np.unique(-self.keys[here], return_inverse=True)
            sums = [
                np.bincount(which, values[here], len(downward)) for values in (liquid, freezing)
            ]
            above = np.append(0.0, np.cumsum(sums[0] - sums[1]))[:-1]
            last = np.searchsorted(above, lack, side="right") + 1
            kept = slice(min(int(last), len(downward)))
            height = self._low - downward[kept] * self._unit
            place = np.full(len(height), float(number))
            rows.append(
                np.column_stack([place, -downward[kept], height, sums[0][kept], sums[1][kept]])
            )
        return np.concatenate(self._comm.allgather(np.concatenate(rows)))
