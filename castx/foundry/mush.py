"""The way an alloy freezes: solid fraction over temperature, and integrals over the mush.

Integrals go over the temperature, ∫ w(f) dT, so that what freezes at one temperature adds nothing
to them, wherever on the way it does, and no law f(T) has to be differentiated.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.materials.solid_fraction import SolidFractionLaw, fraction_at

GRADED, EVEN = 240, 400
"""Intervals of each smooth piece of a law that are graded towards its ends, and even ones."""
SMALLEST = 1e-12
"""Liquid fraction that counts as none, and the smallest interval, as a share of its piece."""
HALVINGS = 60
ROUNDS = 8

Weight = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class FreezingPath:
    """Solid fraction f of an alloy between its solidus and its liquidus.

    Args:
        law: f over temperature.
        solidus: [°C].
        liquidus: above the solidus [°C].

    Raises:
        CaseError: the alloy has no freezing range, and so no mush.
    """

    law: SolidFractionLaw
    solidus: float
    liquidus: float

    def __post_init__(self) -> None:
        if not self.solidus < self.liquidus:
            raise CaseError(
                f"solidus {self.solidus:g} and liquidus {self.liquidus:g} °C leave no freezing "
                "range: a material without a freezing range has no mush"
            )

    @property
    def freezing_range(self) -> float:
        """Liquidus less solidus [K]."""
        return self.liquidus - self.solidus

    def solid_fraction(self, temperature: FloatArray) -> FloatArray:
        """Return f at temperatures (n,) [°C]; at a plateau the value of its liquid side."""
        values = np.atleast_1d(np.asarray(temperature, dtype=np.float64))
        return fraction_at(self.law, self.solidus, self.liquidus, values)

    def temperature(self, fraction: FloatArray) -> FloatArray:
        """Return the temperatures [°C] at which f reaches fractions between 0 and 1, (n,).

        Every fraction of a plateau has the temperature of the plateau.
        """
        wanted = np.atleast_1d(np.asarray(fraction, dtype=np.float64))
        low, high = np.full(wanted.shape, self.solidus), np.full(wanted.shape, self.liquidus)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            reached = self.solid_fraction(middle) >= wanted
            low, high = np.where(reached, middle, low), np.where(reached, high, middle)
        return np.where(self.solid_fraction(high) >= wanted, high, low)

    @cached_property
    def knots(self) -> FloatArray:
        """Temperatures from solidus to liquidus [°C], between which f is smooth, (knots,).

        They lie close at the ends of each smooth piece: where the last liquid freezes, the
        permeability vanishes and integrals over its inverse grow beyond all bounds.
        """
        graded = np.geomspace(SMALLEST, 0.5, GRADED)
        shares = np.unique(np.concatenate([graded, np.linspace(0.0, 1.0, EVEN + 1)]))
        pieces = self.law.pieces(self.solidus, self.liquidus)
        inside = [piece.start + (piece.end - piece.start) * shares for piece in pieces]
        ends = [[piece.end] for piece in pieces]
        bounds = [self.solidus, self.liquidus]
        return np.asarray(np.unique(np.concatenate([bounds, *inside, *ends])))

    def between(self, low: FloatArray, high: FloatArray, weight: Weight) -> FloatArray:
        """Return ∫ w(f) dT of intervals (n,) on which f is smooth, by Gauss's rule of 5 points."""
        points, weights = np.polynomial.legendre.leggauss(5)
        half = 0.5 * (high - low)
        places = low[:, None] + half[:, None] * (points + 1.0)
        solid = self.solid_fraction(places.ravel()).reshape(places.shape)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            values = np.where(solid < 1.0 - SMALLEST, weight(solid), np.inf)
            return np.asarray(np.where(half > 0.0, half * (values @ weights), 0.0))


class MushIntegral:
    """The integral ∫ w(f) dT from a temperature up to the liquidus, and its inverse.

    Args:
        path: of the alloy.
        weight: w, positive, of solid fractions (n,).
    """

    def __init__(self, path: FreezingPath, weight: Weight) -> None:
        self._path, self._weight = path, weight
        knots = path.knots
        own = path.between(knots[:-1], knots[1:], weight)
        above = np.concatenate([np.cumsum(own[::-1])[::-1], [0.0]])
        first = int(np.flatnonzero(np.isfinite(above))[0])
        self._knots, self._above = knots[first:], above[first:]

    def __call__(self, temperature: FloatArray) -> FloatArray:
        """Return the integral from temperatures (n,) [°C]; zero above the liquidus."""
        values = np.clip(np.atleast_1d(temperature), self._path.solidus, self._path.liquidus)
        end = np.clip(np.searchsorted(self._knots, values), 0, self._knots.size - 1)
        rest = self._path.between(values, self._knots[end], self._weight)
        return np.asarray(self._above[end] + rest)

    @property
    def whole(self) -> float:
        """Largest value that is reached where liquid is left."""
        return float(self._above[0])

    def inverse(self, value: FloatArray) -> FloatArray:
        """Return from which temperatures [°C] the integral has values (n,); at most `whole`.

        Newton's method in the interval between two knots, on which the integral is nearly straight.
        """
        wanted = np.clip(np.atleast_1d(value), 0.0, self.whole)
        end = self._knots.size - 1 - np.searchsorted(self._above[::-1], wanted, side="left")
        end = np.clip(end + 1, 1, self._knots.size - 1)
        low, high = self._knots[end - 1], self._knots[end]
        share = self._above[end - 1] - self._above[end]
        beyond = wanted - self._above[end]
        with np.errstate(divide="ignore", invalid="ignore"):
            part = np.where(share > 0.0, beyond / share, 0.0)
            found = high - np.clip(part, 0.0, 1.0) * (high - low)
            for _ in range(ROUNDS):
                miss = beyond - self._path.between(found, high, self._weight)
                slope = self._weight(self._path.solid_fraction(found))
                move = np.where(slope > 0.0, miss / slope, 0.0)
                found = np.clip(found - move, low, high)
        return np.asarray(found)
