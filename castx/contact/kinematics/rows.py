"""Rows in which contact reads node pairs: one for each normal of a pair."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

from castx.arrays import IntArray
from castx.stateful import occurrence

if TYPE_CHECKING:
    from castx.domain.pairs.node_pairs import NodePairs


class Treatment(Enum):
    """What the coordinates of the bodies make of the pairs of an interface.

    READ leaves the bodies alone, CONDENSED makes every gap a coordinate, SLIDING the motions along
    the surface too, TIED makes all relative motions coordinates and holds them.
    """

    READ = "read"
    CONDENSED = "condensed"
    SLIDING = "sliding"
    TIED = "tied"


@dataclass(frozen=True)
class InterfaceRows:
    """The pairs of one interface and what the coordinates make of them.

    Attributes:
        pairs: the node pairs, one or several at each node.
        treatment: what the coordinates make of them.
    """

    pairs: NodePairs
    treatment: Treatment = Treatment.CONDENSED

    def turns(self) -> Iterator[IntArray]:
        """Yield the first pairs of all nodes, then the second ones, and so on."""
        turn = occurrence(self.pairs.secondary_local)
        for k in range(int(turn.max(initial=-1)) + 1):
            yield np.flatnonzero(turn == k).astype(np.int32)
