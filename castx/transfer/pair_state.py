"""State of the node pairs of an interface, handed from contact to heat and results."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import numpy.typing as npt

from castx.arrays import BoolArray, FloatArray

Points = npt.NDArray[np.intp]


@dataclass(frozen=True)
class PairState:
    """Gaps and contact forces of the node pairs of an interface.

    Attributes:
        gap: opening [m], shape (pairs,); zero but for round-off where closed.
        pressure: contact pressure [Pa], shape (pairs,).
        closed: whether the surfaces touch, shape (pairs,).
        force: contact force on the secondary nodes, friction included [N], shape
            (pairs, dimension).
        suction: pull of closed pairs as liquid at the wall feels it, friction left out [Pa], shape
            (pairs,); zero where nothing pulls.
    """

    gap: FloatArray
    pressure: FloatArray
    closed: BoolArray
    force: FloatArray
    suction: FloatArray

    @classmethod
    def of(cls, gap: FloatArray, pressure: FloatArray) -> Self:
        """Return pairs without forces that are closed where the gap [m] is not positive.

        Negative gaps and pressures [Pa] become zero.
        """
        none = np.zeros((len(gap), 0))
        found = cls(
            np.asarray(gap), np.asarray(pressure), np.asarray(gap <= 0.0), none, np.zeros(len(gap))
        )
        return found.clipped()

    def clipped(self, clearance: float = 0.0) -> Self:
        """Return the state that heat transfer depends on: no overlap, no gap of closed pairs.

        Gaps and pressures are not negative, gaps of closed pairs zero, and pairs without a gap
        closed. Gaps begin where the surfaces cease to touch: rough ones do so at a distance, and
        heat would jump there.

        Args:
            clearance: gap from which the surfaces touch [m].
        """
        beyond = self.gap - clearance
        gap = np.maximum(np.where(self.closed, 0.0, beyond), 0.0, dtype=np.float64)
        pressure = np.maximum(self.pressure, 0.0, dtype=np.float64)
        return replace(self, gap=gap, pressure=pressure, closed=gap <= 0.0)

    def at(self, points: Points) -> Self:
        """Return the state of some of the pairs."""
        return type(self)(
            self.gap[points], self.pressure[points], self.closed[points], self.force[points],
            self.suction[points],
        )  # fmt: skip
