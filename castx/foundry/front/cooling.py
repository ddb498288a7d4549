"""Cooling of nodes by their own temperature, while that falls through a window around a level.

The window is a tenth of the freezing range, half of it on either side of the level, and ends where
the range ends. The rate is the width of the window over the time between the passing of its ends.
It needs no neighbours, so that it is the same at a surface as inside and exists without a gradient.

A front that is steep on the mesh goes by nodes in stairs, though: the temperature of a node hurries
when the solidus has reached its neighbour. On case V3, with 0.24 of the freezing range from node to
node, the rate in the window is off by 6 %, Ṫ = G v by 0.5 % only. So the window counts where the
temperatures in the cells round a node are close together in it, and gives way to G v where not.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.foundry.front.excess import Step
from castx.foundry.front.levels import FreezingCurve, Level

if TYPE_CHECKING:
    from castx.foundry.front.control_volumes import ControlVolumes

HALF_WIDTH = 0.05
"""Of the window, as a share of the freezing range."""
GENTLE, STEEP = 0.25, 0.5
"""Differences of temperature in a cell, in widths of the window: up to the first one the window
counts alone, from the second one on not at all."""
SAMPLES = 513
FLAT = 1e-9
"""Fall of the temperature between two samples, in widths of the window, that counts as none."""
BEGIN, MIDDLE, END = range(3)


@dataclass(frozen=True)
class CoolingWindow:
    """A window of temperatures around a level.

    Attributes:
        enthalpies: at its upper end, at the level, and at its lower end [J/m³].
        width: between the ends [K].
    """

    enthalpies: tuple[float, float, float]
    width: float

    @classmethod
    def around(cls, curve: FreezingCurve, level: Level) -> CoolingWindow | None:
        """Return the window around a level; None: something freezes at one temperature in it."""
        liquidus, solidus = Level.of(curve, 0.0), Level.of(curve, 1.0)
        freezing_range = liquidus.temperature - solidus.temperature
        if level.hot - level.cold > FLAT * (liquidus.hot - solidus.cold):
            return None
        high = min(level.temperature + HALF_WIDTH * freezing_range, liquidus.temperature)
        low = max(level.temperature - HALF_WIDTH * freezing_range, solidus.temperature)
        begin, end = Level.at(curve, high).cold, Level.at(curve, low).hot
        samples: FloatArray = np.linspace(end, begin, SAMPLES, dtype=np.float64)
        falling = np.diff(curve.temperature(samples))
        if not (falling > FLAT * freezing_range).all():
            return None
        return cls((begin, level.hot, end), high - low)


class WindowCooling:
    """The cooling of all nodes of a body in a window.

    Attributes:
        times: at which upper end, level and lower end passed the nodes, (3, nodes) [s].
        spread: mean difference of temperature in the cells round a node when the level passed,
            (nodes,) [K].

    Args:
        volumes: control volumes of the body.
        curve: enthalpy of its material.
        window: of temperatures.
    """

    def __init__(
        self, volumes: ControlVolumes, curve: FreezingCurve, window: CoolingWindow
    ) -> None:
        self._volumes, self._curve, self._window = volumes, curve, window
        self._sizes = volumes.volumes.sum(axis=(1, 2))
        self.times: FloatArray
        self.spread: FloatArray
        self.begin()

    def begin(self) -> None:
        """Begin anew, as a body does that has just been poured."""
        self.times = np.full((3, self._volumes.nodes), np.nan)
        self.spread = np.full(self._volumes.nodes, np.nan)

    def follow(self, step: Step, start: float, end: float) -> None:
        """Note times at which a step passes the window; remelting deletes them; collective."""
        levels = np.array(self._window.enthalpies)[:, None]
        passed = (step.start > levels) & (step.end <= levels)
        share: FloatArray = np.zeros(passed.shape)
        np.divide(step.start - levels, step.start - step.end, out=share, where=passed)
        self.times[passed] = start + share[passed] * (end - start)
        self.times[step.end > levels] = np.nan
        frozen = passed[MIDDLE]
        self.spread[frozen] = self._spread(step, frozen, share[MIDDLE])[frozen]

    def _spread(self, step: Step, frozen: BoolArray, share: FloatArray) -> FloatArray:
        """Return the mean difference of temperature in the cells round marked nodes; collective."""
        parts = self._volumes.around(frozen)
        own, corners = self._volumes.cell_nodes[parts], self._volumes.cell_nodes[parts[0]]
        temperature = self._curve.temperature(step.after(share[own][:, None], corners))
        sizes = self._sizes[parts[0]]
        sums = [self._volumes.at_nodes(parts, values)
                for values in (sizes * np.ptp(temperature, axis=1), sizes)]  # fmt: skip
        weighted, total = self._volumes.added(sums)
        means: FloatArray = np.zeros_like(total)
        np.divide(weighted, total, out=means, where=total > 0.0)
        return means

    @property
    def passing(self) -> FloatArray:
        """When the level passed the temperature of the nodes [s], (nodes,)."""
        return np.asarray(self.times[MIDDLE])

    def rate(self) -> FloatArray:
        """Return the cooling rate in the window [K/s], (nodes,); not a number before its end."""
        return np.asarray(self._window.width / (self.times[END] - self.times[BEGIN]))

    def weight(self) -> FloatArray:
        """Return the weight of the cooling rate, from 0 to 1, (nodes,); 0 without a rate."""
        steepness = self.spread / self._window.width
        weight = np.clip((STEEP - steepness) / (STEEP - GENTLE), 0.0, 1.0)
        return np.where(np.isfinite(self.rate()), weight, 0.0)
