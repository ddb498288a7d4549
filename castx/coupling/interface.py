"""An interface as the coupling of heat and mechanics sees it, and the state of its pairs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.domain.pairs.node_pairs import NodePairs
from castx.transfer.conductance import PairState


@dataclass(frozen=True)
class CoupledInterface:
    """An interface, with or without contact, that heat crosses or not.

    Attributes:
        name: "secondary/primary".
        pairs: its node pairs.
        initial_gap: gaps without displacement [m], shape (pairs,).
        contact: number of the interface among those with contact; None: it has none.
    """

    name: str
    pairs: NodePairs
    initial_gap: FloatArray
    contact: int | None


@dataclass(frozen=True)
class InterfaceState:
    """The pairs of an interface.

    Attributes:
        gap: [m], shape (pairs,).
        pressure: contact pressure [Pa].
        resistance: R = 1/h [m² K/W], without radiation.
        closed: whether the pair touches; the gap of one that does is zero but for round-off.
        force: of contact on the secondary nodes [N], shape (pairs, dimension).
    """

    gap: FloatArray
    pressure: FloatArray
    resistance: FloatArray
    closed: BoolArray
    force: FloatArray

    @property
    def felt(self) -> PairState:
        """The state as heat feels it: pairs that touch have no gap at all."""
        return PairState.of(np.where(self.closed, 0.0, self.gap), self.pressure)
