"""An interface as the coupling of heat and mechanics sees it, and the state of its pairs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from castx.pairs import NodePairs
from castx.tables import FloatArray

BoolArray = npt.NDArray[np.bool_]


class HeatLaw(Protocol):
    """Heat-transfer coefficient of an interface."""

    def coefficient(self, gap: FloatArray, pressure: FloatArray) -> FloatArray:
        """Return h [W/m²/K] at gaps [m] and contact pressures [Pa]."""


@dataclass(frozen=True)
class CoupledInterface:
    """An interface, with or without contact, that heat crosses or not.

    Attributes:
        name: "secondary/primary".
        pairs: its node pairs.
        law: law of the heat transfer; None: no heat crosses.
        initial_gap: gaps without displacement [m], shape (pairs,).
        contact: number of the interface among those with contact; None: it has none.
        exchanges: whether the heat problem takes resistances for it.
    """

    name: str
    pairs: NodePairs
    law: HeatLaw | None
    initial_gap: FloatArray
    contact: int | None
    exchanges: bool

    def resistance(self, gap: FloatArray, pressure: FloatArray) -> FloatArray:
        """Return R = 1/h [m² K/W] at gaps [m] and contact pressures [Pa]; infinite: no law."""
        if self.law is None:
            return np.full(len(gap), np.inf)
        with np.errstate(divide="ignore"):
            return np.asarray(1.0 / self.law.coefficient(gap, pressure))


@dataclass(frozen=True)
class InterfaceState:
    """The pairs of an interface.

    Attributes:
        gap: [m], shape (pairs,).
        pressure: contact pressure [Pa].
        resistance: R = 1/h [m² K/W].
        closed: whether the pair touches; the gap of one that does is zero but for round-off.
    """

    gap: FloatArray
    pressure: FloatArray
    resistance: FloatArray
    closed: BoolArray
