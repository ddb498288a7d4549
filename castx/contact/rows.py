"""Rows in which contact reads node pairs: one for each normal of a pair."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from castx.pairs import NodePairs

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int32]


class Treatment(Enum):
    """What the coordinates of the bodies make of the pairs of an interface.

    READ leaves the bodies alone, CONDENSED makes every gap a coordinate, TIED makes all relative
    motions coordinates and holds them.
    """

    READ = "read"
    CONDENSED = "condensed"
    TIED = "tied"


@dataclass(frozen=True)
class PairRows:
    """The pairs of one interface and their normals, one or several for each pair.

    Attributes:
        pairs: the node pairs.
        index: number of the pair of each row, shape (rows,).
        vectors: area vectors ∫φ n dS of the rows [m²], shape (rows, dimension).
        treatment: what the coordinates make of them.
    """

    pairs: NodePairs
    index: IntArray
    vectors: FloatArray
    treatment: Treatment = Treatment.CONDENSED

    @property
    def nodes(self) -> IntArray:
        """Local numbers of the secondary nodes of the rows, shape (rows,)."""
        return self.pairs.secondary_local[self.index]

    def turns(self) -> Iterator[IntArray]:
        """Yield the first rows of all nodes, then the second ones, and so on."""
        turn = turn_of(self.nodes)
        for k in range(int(turn.max(initial=-1)) + 1):
            yield np.flatnonzero(turn == k).astype(np.int32)


def turn_of(owners: IntArray) -> npt.NDArray[np.int64]:
    """Return how many rows of the same owner stand before each row, shape (rows,)."""
    order = np.argsort(owners, kind="stable")
    first = np.searchsorted(owners[order], owners[order])
    turn = np.empty(len(order), dtype=np.int64)
    turn[order] = np.arange(len(order)) - first
    return turn


def single_rows(pairs: NodePairs, treatment: Treatment = Treatment.CONDENSED) -> PairRows:
    """Return one row for each pair, along the mean normal of its surface."""
    index = np.arange(len(pairs.areas), dtype=np.int32)
    return PairRows(pairs, index, pairs.area_vectors, treatment)
