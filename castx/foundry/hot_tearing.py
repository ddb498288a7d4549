"""Hot-tearing indices from the way of freezing alone: Clyne and Davies, Kou.

Neither has a stress or a strain in it: they rank alloys and places, and have no threshold.
"""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.mush import FreezingPath

RELAXED, VULNERABLE, BRIDGED = 0.4, 0.9, 0.99
"""Solid fractions between which feeding relieves stress, from which it does not, until which."""
KOU_RANGE = (0.87, 0.94)
SAMPLES = 2001
"""Temperatures at which each smooth piece of f(T) is differentiated."""


def clyne_davies(
    at_relaxed: FloatArray, at_vulnerable: FloatArray, at_bridged: FloatArray
) -> FloatArray:
    """Return CSC = (t_0.99 - t_0.9)/(t_0.9 - t_0.4) from times at which a place passes f.

    The time in which melt hardly feeds any more, over that in which it relieves stress. After T. W.
    Clyne and G. J. Davies, in the form and with the fractions that public codes use today.

    Args:
        at_relaxed: t_0.4 [s], or of another fraction; all three of one shape.
        at_vulnerable: t_0.9 [s].
        at_bridged: t_0.99 [s].

    Returns:
        The ratio; infinite where no time was left for relief, not a number where all passed at
        once.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        relief = np.asarray(at_vulnerable) - at_relaxed
        return np.asarray((np.asarray(at_bridged) - at_vulnerable) / relief)


def clyne_davies_of_alloy(path: FreezingPath) -> float:
    """Return CSC = (T_0.9 - T_0.99)/(T_0.4 - T_0.9), the form of a material that cools evenly."""
    fractions = np.array([RELAXED, VULNERABLE, BRIDGED])
    return float(clyne_davies(*(-path.temperature(fractions))))


def kou(path: FreezingPath, between: tuple[float, float] = KOU_RANGE) -> float:
    """Return Kou's index, max |dT/d√f| for 0.87 < f < 0.94 [K].

    After S. Kou (2015). A table of f(T) is differentiated row by row, so that its spacing decides:
    state it. What freezes at one
    temperature has no slope; a range that all freezes so has the index 0.

    Args:
        path: of the alloy.
        between: the range of solid fractions.
    """
    low, high = (float(path.temperature(np.array([f]))[0]) for f in reversed(between))
    largest = 0.0
    for piece in path.law.pieces(path.solidus, path.liquidus):
        start, end = max(low, piece.start), min(high, piece.end)
        if not start < end:
            continue
        temperature: FloatArray = np.linspace(start, end, SAMPLES, dtype=np.float64)
        solid = piece.fraction(temperature)
        slope = np.abs(np.gradient(solid, temperature, edge_order=2))
        falling = slope > 0.0
        steep = 2.0 * np.sqrt(solid[falling]) / slope[falling]
        largest = max(largest, float(steep.max(initial=0.0)))
    return largest
