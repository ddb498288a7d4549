"""Facing surfaces of node pairs, their conductance, and the protocol of its laws."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol, Self

import numpy as np

from castx.arrays import FloatArray
from castx.transfer.duals import Dual
from castx.transfer.pair_state import PairState, Points

SECONDARY, PRIMARY, SOLID = range(3)
"""Variables over which laws are differentiated: both face temperatures, the solid fraction."""
VARIABLES = 3


@dataclass(frozen=True)
class Faces:
    """The facing surfaces of node pairs at one moment.

    Attributes:
        secondary: temperature of the secondary nodes [°C], shape (pairs,).
        primary: of the primary nodes.
        solid_fraction: mean over the volume of the secondary body.
        time: [s].
    """

    secondary: Dual
    primary: Dual
    solid_fraction: Dual
    time: float

    @classmethod
    def at_temperatures(
        cls, secondary: FloatArray, primary: FloatArray, time: float, solid_fraction: float
    ) -> Self:
        """Return faces whose temperatures and solid fraction are the variables."""
        solid = np.full(len(secondary), solid_fraction)
        return cls(
            Dual.variable(secondary, SECONDARY, VARIABLES),
            Dual.variable(primary, PRIMARY, VARIABLES),
            Dual.variable(solid, SOLID, VARIABLES),
            time,
        )

    def temperature(self, of: str) -> Dual:
        """Return a temperature of the pairs, of "secondary", "primary" or their "mean"."""
        match of:
            case "secondary":
                return self.secondary
            case "primary":
                return self.primary
            case _:
                return (self.secondary + self.primary) * 0.5

    def at(self, points: Points) -> Faces:
        """Return the surfaces of some of the pairs."""
        return Faces(
            self.secondary.at(points),
            self.primary.at(points),
            self.solid_fraction.at(points),
            self.time,
        )


@dataclass(frozen=True)
class Conductance:
    """Heat-transfer coefficient of node pairs without radiation.

    Attributes:
        coefficient: h [W/m²/K], shape (pairs,).
        contact: share of it that passes where surfaces touch; the rest passes through the gas.
    """

    coefficient: Dual
    contact: FloatArray


class ConductionLaw(Protocol):
    """Conduction between facing surfaces."""

    @property
    def needs_solid_fraction(self) -> bool:
        """Whether the coefficient depends on the solid fraction of the secondary body."""

    def __call__(self, state: PairState, faces: Faces) -> Conductance:
        """Return the conductance of pairs in a state that is `PairState.clipped`."""


@dataclass(frozen=True)
class ConstantConductance:
    """One coefficient throughout; none by default.

    Attributes:
        coefficient: h [W/m²/K].
        needs_solid_fraction: never.
    """

    coefficient: float = 0.0
    needs_solid_fraction: Literal[False] = False

    def __call__(self, state: PairState, faces: Faces) -> Conductance:
        """Return the coefficient; in open pairs the gas carries it."""
        h = np.full(len(state.gap), self.coefficient)
        return Conductance(Dual.constant(h, VARIABLES), touching(state))


UNIT = ConstantConductance(1.0)
"""The law of an interface of which nothing else is said."""


def touching(state: PairState) -> FloatArray:
    """Return 1 for closed and 0 for open pairs, shape (pairs,)."""
    return np.asarray(state.closed, dtype=np.float64)
