"""Laws f_s(T) of the solid fraction between solidus and liquidus.

A law is a list of smooth pieces with increasing temperature. Where the fractions of two neighbours
differ, or differ from 1 at the solidus or 0 at the liquidus, the difference freezes isothermally.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from castx.arrays import FloatArray

SMALLEST_JUMP = 1e-12
"""Difference of solid fraction below which two pieces count as continuous."""


@dataclass(frozen=True)
class FractionPiece:
    """Interval of temperature [°C] on which the solid fraction is smooth.

    Attributes:
        start: lowest temperature [°C].
        end: highest temperature [°C].
        fraction: f_s at temperatures of the interval [°C].
        temperature: its inverse [°C], at fractions between those of both ends, if they differ.
    """

    start: float
    end: float
    fraction: Callable[[FloatArray], FloatArray]
    temperature: Callable[[float], float]


class SolidFractionLaw(Protocol):
    """Law by which the solid fraction falls from solidus to liquidus."""

    def pieces(self, solidus: float, liquidus: float) -> tuple[FractionPiece, ...]:
        """Return the smooth pieces that fill [solidus, liquidus]; none when the two are equal."""
        ...


def fraction_at(
    law: SolidFractionLaw, solidus: float, liquidus: float, temperature: FloatArray
) -> FloatArray:
    """Return the solid fraction at temperatures [°C]; at a plateau the liquid side of the jump."""
    fraction = np.where(temperature < solidus, 1.0, 0.0)
    for piece in law.pieces(solidus, liquidus):
        inside = (temperature >= piece.start) & (temperature < piece.end)
        fraction[inside] = piece.fraction(temperature[inside])
    return fraction


def temperature_at(
    law: SolidFractionLaw, solidus: float, liquidus: float, fraction: float
) -> float:
    """Return the highest temperature at which there is a solid fraction, or more [°C]."""
    for piece in reversed(law.pieces(solidus, liquidus)):
        most, least = piece.fraction(np.array([piece.start, piece.end]))
        if fraction <= least:
            return piece.end
        if fraction <= most:
            return min(max(piece.temperature(fraction), piece.start), piece.end)
    return solidus


class Plateau(NamedTuple):
    """Part of a metal that freezes at one temperature.

    Attributes:
        temperature: [°C].
        begin: solid fraction of the liquid side.
        end: solid fraction of the solid side.
    """

    temperature: float
    begin: float
    end: float


def plateaus(law: SolidFractionLaw, solidus: float, liquidus: float) -> tuple[Plateau, ...]:
    """Return the plateaus of a law, parts that freeze at one temperature, the coldest first."""
    pieces = law.pieces(solidus, liquidus)
    below = [1.0, *(float(piece.fraction(np.array([piece.end]))[0]) for piece in pieces)]
    above = [*(float(piece.fraction(np.array([piece.start]))[0]) for piece in pieces), 0.0]
    places = [*(piece.start for piece in pieces), liquidus]
    return tuple(
        Plateau(place, hot, cold)
        for place, cold, hot in zip(places, below, above, strict=True)
        if cold - hot > SMALLEST_JUMP
    )


def linear_piece(start: float, end: float, first: float, last: float) -> FractionPiece:
    """Return the piece on which the fraction runs straight from `first` to `last`."""

    def fraction(temperature: FloatArray) -> FloatArray:
        weight = (temperature - start) / (end - start)
        return first * (1.0 - weight) + last * weight

    def temperature(fraction: float) -> float:
        return start + (end - start) * (first - fraction) / (first - last)

    return FractionPiece(start, end, fraction, temperature)


@dataclass(frozen=True)
class LinearLaw:
    """Solid fraction linear in temperature; also the law of an isothermal change."""

    def pieces(self, solidus: float, liquidus: float) -> tuple[FractionPiece, ...]:
        """Return the single straight piece of the curve."""
        return (linear_piece(solidus, liquidus, 1.0, 0.0),) if solidus < liquidus else ()


@dataclass(frozen=True)
class LeverLaw:
    """Equilibrium of a binary alloy with straight phase lines, diffusion complete in both phases.

    f_s = (T_l − T) / ((1 − k)(T_m − T)), at most 1; liquid left at the solidus freezes as eutectic.
    It is the lever rule, the balance of solute between both phases.

    Args:
        partition_coefficient: k, between 0 and 1.
        melting_point: T_m of the pure base metal, above the liquidus [°C].
    """

    partition_coefficient: float
    melting_point: float

    def pieces(self, solidus: float, liquidus: float) -> tuple[FractionPiece, ...]:
        """Return the curved piece, and one fully solid piece below the equilibrium solidus."""

        def fraction(temperature: FloatArray) -> FloatArray:
            contrast = (1.0 - self.partition_coefficient) * (self.melting_point - temperature)
            return np.minimum((liquidus - temperature) / contrast, 1.0)

        def temperature(fraction: float) -> float:
            left = (1.0 - self.partition_coefficient) * fraction
            return (liquidus - left * self.melting_point) / (1.0 - left)

        depression = self.melting_point - liquidus
        equilibrium = self.melting_point - depression / self.partition_coefficient
        if equilibrium <= solidus:
            return (FractionPiece(solidus, liquidus, fraction, temperature),)
        return (
            linear_piece(solidus, equilibrium, 1.0, 1.0),
            FractionPiece(equilibrium, liquidus, fraction, temperature),
        )


@dataclass(frozen=True)
class ScheilLaw:
    """Binary alloy with straight phase lines, no diffusion in the solid (Gulliver, Scheil).

    f_s = 1 − ((T_m − T)/(T_m − T_l))^(1/(k − 1)); liquid left at the solidus freezes as eutectic.
    Source: E. Scheil, Z. Metallkunde 34 (1942) 70.

    Args:
        partition_coefficient: k, between 0 and 1.
        melting_point: T_m of the pure base metal, above the liquidus [°C].
    """

    partition_coefficient: float
    melting_point: float

    def pieces(self, solidus: float, liquidus: float) -> tuple[FractionPiece, ...]:
        """Return the single curved piece of the curve."""

        def fraction(temperature: FloatArray) -> FloatArray:
            ratio = (self.melting_point - temperature) / (self.melting_point - liquidus)
            return 1.0 - ratio ** (1.0 / (self.partition_coefficient - 1.0))

        def temperature(fraction: float) -> float:
            if fraction >= 1.0:
                return solidus  # liquid is left at every other one, be it less than rounding
            ratio = math.pow(1.0 - fraction, self.partition_coefficient - 1.0)
            return self.melting_point - ratio * (self.melting_point - liquidus)

        return (FractionPiece(solidus, liquidus, fraction, temperature),)


@dataclass(frozen=True)
class TabulatedLaw:
    """Solid fraction through rows of (°C, f_s); a temperature given twice is a plateau.

    Args:
        rows: temperatures not decreasing, fractions between 0 and 1 and not increasing; the first
            temperature is the solidus, the last the liquidus.
    """

    rows: tuple[tuple[float, float], ...]

    @property
    def solidus(self) -> float:
        """Lowest temperature of the table [°C]."""
        return self.rows[0][0]

    @property
    def liquidus(self) -> float:
        """Highest temperature of the table [°C]."""
        return self.rows[-1][0]

    def pieces(self, solidus: float, liquidus: float) -> tuple[FractionPiece, ...]:
        """Return a straight piece between each two rows of different temperature."""
        neighbours = zip(self.rows[:-1], self.rows[1:], strict=True)
        return tuple(
            linear_piece(start, end, first, last)
            for (start, first), (end, last) in neighbours
            if solidus <= start < end <= liquidus
        )
