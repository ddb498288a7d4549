"""Rows of node pairs, one for each normal of a pair, and their treatment."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

from castx.arrays import IntArray
from castx.stateful import occurrence

if TYPE_CHECKING:
    from castx.contact.kinematics.midside_shares import MidsideShares
    from castx.domain.pairs.facet_pairs import FacetPairs
    from castx.domain.pairs.node_pairs import NodePairs


class Treatment(Enum):
    """Treatment of the pairs of an interface by the change of unknowns.

    UNCHANGED leaves the unknowns alone, CONDENSED makes every gap an unknown, SLIDING the motions
    along the surface too, TIED makes all relative motions unknowns and fixes them at zero.
    """

    UNCHANGED = "unchanged"
    CONDENSED = "condensed"
    SLIDING = "sliding"
    TIED = "tied"


@dataclass(frozen=True)
class InterfaceRows:
    """Pairs of one interface and their treatment: relative, tied or unchanged.

    Attributes:
        pairs: the node pairs, one or several at each node.
        treatment: by the change of unknowns.
        midsides: what the mid-sides of quadratic bodies have in the pairs.
        facets: round the pairs; None: nothing asks for them.
    """

    pairs: NodePairs
    treatment: Treatment = Treatment.CONDENSED
    midsides: Sequence[MidsideShares] = ()
    facets: FacetPairs | None = None

    def by_order_at_node(self) -> Iterator[IntArray]:
        """Yield the first pairs of all nodes, then the second ones, and so on."""
        order = occurrence(self.pairs.secondary_local)
        for k in range(int(order.max(initial=-1)) + 1):
            yield np.flatnonzero(order == k).astype(np.int32)
