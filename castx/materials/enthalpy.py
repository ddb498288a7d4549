"""Volumetric enthalpy H(T) of one material and its exact inverse.

H(T) = ∫ρ c dT + ρ L (1 − f_s), the integral from 0 °C, with reference density ρ and
c = f_s c_solid + (1 − f_s) c_liquid. The nodal enthalpy is the unknown of the heat equation.

The curve is stored as knots (T, H, f_s) with straight lines between them. One pair of searched
arrays then gives T(H), f_s(H) and both slopes consistently, the slope of a plateau is an exact
zero, and T(H(T)) = T to round-off. The knots are set so that the straight lines stay within 1e-5 K
of the law; where c is constant and f_s linear, or nothing freezes, they are exact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.materials.phased import Phased
from castx.materials.solid_fraction import (
    SMALLEST_JUMP,
    FractionPiece,
    SolidFractionLaw,
    linear_piece,
)

CURVE_TOLERANCE = 1e-5
"""Largest distance of the stored curve from the law [K]."""

Rise = Callable[[FloatArray, FloatArray], FloatArray]


class HeatState(NamedTuple):
    """Temperature [°C] and solid fraction of nodes at one time, each of shape (nodes,)."""

    temperature: FloatArray
    solid_fraction: FloatArray


@dataclass(frozen=True, eq=False)
class EnthalpyCurve:
    """Enthalpy, temperature and solid fraction of a material, each a function of the other.

    Outside the knots the curve goes on straight. At a knot the slopes over H are the slopes of
    the side with the larger H.

    Args:
        temperatures: knots, not decreasing, shape (knots,) [°C]; equal ones bound a plateau.
        enthalpies: knots, increasing, shape (knots,) [J/m³].
        fractions: solid fraction at the knots, not increasing, shape (knots,).
    """

    temperatures: FloatArray
    enthalpies: FloatArray
    fractions: FloatArray

    def __post_init__(self) -> None:
        for array in (self.temperatures, self.enthalpies, self.fractions):
            array.setflags(write=False)

    def enthalpy(self, temperature: Any) -> FloatArray:
        """Return H [J/m³] at temperatures [°C].

        At the temperature of a plateau this is its upper end: at the melting point of an
        isothermal material the value of the liquid, at any lower temperature that of the solid.
        """
        start = self._cell(self.temperatures, temperature)
        width = self.temperatures[start + 1] - self.temperatures[start]
        capacity = (self.enthalpies[start + 1] - self.enthalpies[start]) / width
        return np.asarray(
            self.enthalpies[start] + capacity * (temperature - self.temperatures[start])
        )

    def state(self, enthalpy: FloatArray) -> HeatState:
        """Return the state of nodes at enthalpies [J/m³], shape (nodes,)."""
        return HeatState(self.temperature(enthalpy), self.solid_fraction(enthalpy))

    def temperature(self, enthalpy: Any) -> FloatArray:
        """Return T [°C] at enthalpies [J/m³]; constant to the last bit on a plateau."""
        start = self._cell(self.enthalpies, enthalpy)
        slope = self._slope(self.temperatures, start)
        return np.asarray(self.temperatures[start] + slope * (enthalpy - self.enthalpies[start]))

    def temperature_slope(self, enthalpy: Any) -> FloatArray:
        """Return dT/dH [K m³/J]; exactly zero on a plateau."""
        return self._slope(self.temperatures, self._cell(self.enthalpies, enthalpy))

    def solid_fraction(self, enthalpy: Any) -> FloatArray:
        """Return f_s at enthalpies [J/m³]."""
        start = self._cell(self.enthalpies, enthalpy)
        slope = self._slope(self.fractions, start)
        fraction = self.fractions[start] + slope * (enthalpy - self.enthalpies[start])
        return np.asarray(np.clip(fraction, 0.0, 1.0))

    def solid_fraction_slope(self, enthalpy: Any) -> FloatArray:
        """Return df_s/dH [m³/J]; zero where nothing freezes."""
        return self._slope(self.fractions, self._cell(self.enthalpies, enthalpy))

    def _cell(self, knots: FloatArray, values: Any) -> npt.NDArray[np.intp]:
        """Return the number of the knot at which the cell of each value starts."""
        start = np.searchsorted(knots, values, side="right") - 1
        cells: npt.NDArray[np.intp] = np.clip(start, 0, knots.size - 2)
        return cells

    def _slope(self, knots: FloatArray, start: npt.NDArray[np.intp]) -> FloatArray:
        """Return the derivative over H of a quantity in the cells."""
        return np.asarray(
            (knots[start + 1] - knots[start])
            / (self.enthalpies[start + 1] - self.enthalpies[start])
        )


def enthalpy_curve(
    density: float,
    heat_capacity: Phased,
    *,
    latent_heat: float = 0.0,
    solidus: float | None = None,
    liquidus: float | None = None,
    law: SolidFractionLaw | None = None,
) -> EnthalpyCurve:
    """Build the curve of a material; without solidus, liquidus and law it never melts.

    H(T) = ∫ρ c dT + ρ L (1 − f_s), the integral from 0 °C.

    Args:
        density: reference density [kg/m³].
        heat_capacity: per mass [J/kg/K], positive.
        latent_heat: per mass [J/kg], not negative.
        solidus: fully solid below [°C].
        liquidus: fully liquid from here [°C].
        law: solid fraction between the two.

    Raises:
        CaseError: H does not increase in floating-point numbers where the temperature does.
    """
    breaks = _breaks(heat_capacity, solidus, liquidus)
    if solidus is None or liquidus is None or law is None:
        pieces = [linear_piece(breaks[0], breaks[-1], 1.0, 1.0)]
    else:
        pieces = [
            linear_piece(breaks[0], solidus, 1.0, 1.0),
            *law.pieces(solidus, liquidus),
            linear_piece(liquidus, breaks[-1], 0.0, 0.0),
        ]
    latent = density * latent_heat
    curve = _join(
        [_sampled(piece, breaks, density, heat_capacity, latent) for piece in pieces], latent
    )
    at_zero = curve.enthalpy(0.0)
    wanted = latent * (1.0 - curve.solid_fraction(at_zero))
    shifted = replace(curve, enthalpies=curve.enthalpies + (wanted - at_zero))
    _check_increase(shifted)
    return shifted


def _check_increase(curve: EnthalpyCurve) -> None:
    wide = np.diff(curve.temperatures) > CURVE_TOLERANCE
    flat = (np.diff(curve.enthalpies) <= 0.0) & wide
    if flat.any():
        at = int(np.flatnonzero(flat)[0])
        low, high = curve.temperatures[at : at + 2]
        raise CaseError(
            f"the enthalpy does not increase from {low:g} to {high:g} °C: the heat capacity there "
            "vanishes beside the rest; make it larger"
        )


def _breaks(heat_capacity: Phased, solidus: float | None, liquidus: float | None) -> FloatArray:
    """Return the temperatures at which c may bend, with 0 °C and a margin of 1 K at both ends."""
    own = [temperature for temperature in (0.0, solidus, liquidus) if temperature is not None]
    tables = [t.arguments for t in (heat_capacity.solid, heat_capacity.liquid) if not t.is_constant]
    inner = np.unique(np.concatenate([np.array(own), *tables]))
    return np.concatenate(([inner[0] - 1.0], inner, [inner[-1] + 1.0]))


def _sampled(
    piece: FractionPiece, breaks: FloatArray, density: float, heat_capacity: Phased, latent: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return knots of a piece: temperatures, enthalpies counted from its start, fractions."""
    points, weights = np.polynomial.legendre.leggauss(5)

    def rise(start: FloatArray, end: FloatArray) -> FloatArray:
        """Return H(end) − H(start) of intervals on which c is smooth."""
        temperature = start[:, None] + 0.5 * (end - start)[:, None] * (points + 1.0)
        capacity = density * heat_capacity(temperature, piece.fraction(temperature))
        freed = latent * (piece.fraction(start) - piece.fraction(end))
        return np.asarray(0.5 * (end - start) * (capacity @ weights) + freed)

    inside = breaks[(breaks > piece.start) & (breaks < piece.end)]
    knots = _refined(np.concatenate(([piece.start], inside, [piece.end])), rise)
    heights = np.concatenate(([0.0], np.cumsum(rise(knots[:-1], knots[1:]))))
    return knots, heights, piece.fraction(knots)


def _refined(knots: FloatArray, rise: Rise) -> FloatArray:
    """Halve the cells until straight lines lie within `CURVE_TOLERANCE` of H at their quarters."""
    while True:
        start, end = knots[:-1], knots[1:]
        quarters = [start + part * (end - start) for part in (0.25, 0.5, 0.75)]
        total = rise(start, end)
        coarse = np.zeros(start.shape, dtype=bool)
        for part, point in zip((0.25, 0.5, 0.75), quarters, strict=True):
            bow = np.abs(rise(start, point) - part * total)
            coarse |= bow * (end - start) > CURVE_TOLERANCE * total
        if not coarse.any():
            return knots
        knots = np.sort(np.concatenate((knots, quarters[1][coarse])))


def _join(parts: list[tuple[FloatArray, FloatArray, FloatArray]], latent: float) -> EnthalpyCurve:
    """Chain the pieces; where the fraction jumps, both knots stay and bound a plateau."""
    temperatures, enthalpies, fractions = (list(values) for values in parts[0])
    for knots, heights, part in parts[1:]:
        jump = fractions[-1] - part[0]
        first, freed = (0, jump * latent) if jump > SMALLEST_JUMP else (1, 0.0)
        base = enthalpies[-1] + freed
        temperatures.extend(knots[first:])
        enthalpies.extend(base + heights[first:])
        fractions.extend(part[first:])
    return EnthalpyCurve(np.array(temperatures), np.array(enthalpies), np.array(fractions))
