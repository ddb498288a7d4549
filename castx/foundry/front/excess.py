"""Enthalpy of nodes over the one that they have with a front at them, where parts of cells say.

With the front at a node, a plane across the temperature gradient at T*, the temperature of the
level, the mean enthalpy of the control volume of the node is

    H_mean = 1/V ∫ H(T* + G± s) dV,  s the distance from the front, G+ where s > 0, G- where s < 0.

The same holds with the front at either side of the control volume, as it enters and leaves it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.foundry.front.control_volumes import ControlVolumes
from castx.foundry.front.levels import FreezingCurve, Level

PLACES, WEIGHTS = (-0.5, 0.0, 0.5), (0.25, 0.5, 0.25)
"""Places of the front, in widths of the control volume from its node, and their weights."""

NEAR = 0.1
"""Distance from the front, in widths of the control volume, from which a node shows a gradient."""
BARELY = 1e-7
"""Share of a plateau in which a front enters and leaves: liquid without superheat is that cold."""


@dataclass(frozen=True)
class Step:
    """Enthalpies of the nodes at the ends of a step, linear between them.

    Attributes:
        start: (nodes,) [J/m³].
        end: (nodes,) [J/m³].
    """

    start: FloatArray
    end: FloatArray

    def after(self, share: FloatArray, nodes: LongArray) -> FloatArray:
        """Return enthalpies of nodes after a share of the step, two arrays of one shape."""
        return np.asarray(self.start[nodes] + share * (self.end[nodes] - self.start[nodes]))


@dataclass(frozen=True)
class Parts:
    """The parts of the control volumes of some nodes, and where they lie across the front.

    Attributes:
        index: cell and corner of each part, two arrays (parts,).
        nodes: node of each part, (parts,).
        corners: nodes of its cell, (parts, corners).
        points: distance of its points from the node along the temperature gradient, (parts, points)
            [m].
        others: the same of the nodes of its cell, (parts, corners).
        width: of the control volume in that direction, (parts,) [m].
    """

    index: tuple[LongArray, LongArray]
    nodes: LongArray
    corners: LongArray
    points: FloatArray
    others: FloatArray
    width: FloatArray

    def of(self, nodes: BoolArray) -> Parts:
        """Return the parts of the given nodes (nodes,) alone."""
        kept = nodes[self.nodes]
        cells, corners = self.index
        return Parts(
            (cells[kept], corners[kept]), self.nodes[kept], self.corners[kept],
            self.points[kept], self.others[kept], self.width[kept],
        )  # fmt: skip


def narrowed(parts: Sequence[Parts], nodes: BoolArray) -> list[Parts]:
    """Return the parts of the nodes that are asked for of each, of shape (len(parts), nodes)."""
    return [of.of(nodes[number]) for number, of in enumerate(parts)]


class Excess:
    """Excess of the enthalpies of nodes over the enthalpies with a front at them.

    Args:
        curve: enthalpy of the material.
        levels: whose fronts these are.
        volumes: control volumes of the nodes.
        sizes: volumes of the cells, (cells,).
    """

    def __init__(
        self,
        curve: FreezingCurve,
        levels: Sequence[Level],
        volumes: ControlVolumes,
        sizes: FloatArray,
    ) -> None:
        self._curve, self._levels = curve, levels
        self._volumes, self._sizes = volumes, sizes

    def at(self, step: Step, share: float, parts: Sequence[Parts]) -> FloatArray:
        """Return the excess after one share of the step for all nodes; collective."""
        nodes = np.arange(step.start.size)
        temperature = self._curve.temperature(step.after(np.full(nodes.size, share), nodes))
        shape = len(self._levels), len(PLACES), nodes.size
        at_corners = [temperature[of.corners] for of in parts]
        return self._of(step, np.full(shape, share), parts, at_corners)

    def after(self, step: Step, share: FloatArray, parts: Sequence[Parts]) -> FloatArray:
        """Return the excess of enthalpies over those with the fronts at `PLACES`; collective.

        Args:
            step: enthalpies.
            share: of the step, (different levels, places, nodes).
            parts: for each of those levels and places the control volumes of the nodes asked for;
                the others have no meaning.

        Returns:
            (different levels, places, nodes) [J/m³].
        """
        shares = share.reshape(len(parts), -1)
        temperatures = [
            self._curve.temperature(step.after(one[of.nodes][:, None], of.corners))
            for one, of in zip(shares, parts, strict=True)
        ]
        return self._of(step, share, parts, temperatures)

    def _of(
        self,
        step: Step,
        share: FloatArray,
        parts: Sequence[Parts],
        temperatures: Sequence[FloatArray],
    ) -> FloatArray:
        """Return the excess where the corners of the parts have temperatures [°C]."""
        cases: list[tuple[Level, float]] = list(product(self._levels, PLACES))
        shares = share.reshape(len(cases), -1)
        found = zip(cases, temperatures, strict=True)
        rises = [values - level.temperature for (level, _), values in found]
        slopes = self._slopes(rises, parts)
        sums = []
        for (level, place), of, ahead, behind in zip(cases, parts, *slopes, strict=True):
            distance = of.points - place * of.width[:, None]
            slope = np.where(distance > 0.0, ahead[of.nodes, None], behind[of.nodes, None])
            temperature = level.temperature + slope * distance
            values = level.enthalpy_beside(self._curve, temperature, distance)
            sums.append(self._volumes.shares(of.index, values))
        own = step.start + shares * (step.end - step.start)
        own -= [[2.0 * place * BARELY * (level.hot - level.cold)] for level, place in cases]
        return (own - self._volumes.added(sums)).reshape(share.shape)

    def _slopes(self, rises: Sequence[FloatArray], parts: Sequence[Parts]) -> FloatArray:
        """Return the gradients ahead of and behind each front, least squares; collective.

        Args:
            rises: temperatures of the nodes of the cells over the front's, (parts, corners) [K].
            parts: control volumes.

        Returns:
            Ahead and behind, (2, fronts, nodes) [K/m].
        """
        sums = []
        for rise, of, place in zip(rises, parts, PLACES * len(self._levels), strict=True):
            distance = of.others - place * of.width[:, None]
            others = of.corners != of.nodes[:, None]
            sizes = self._sizes[of.index[0], None]
            for sign in (1.0, -1.0):
                counted = others & (sign * distance > NEAR * of.width[:, None])
                for terms in (rise * distance, distance**2):
                    values = np.where(counted, sizes * terms, 0.0).sum(axis=1)
                    sums.append(self._volumes.at_nodes(of.index, values))
        products, squares = self._volumes.added(sums).reshape(len(parts), 2, 2, -1).swapaxes(0, 2)
        slopes: FloatArray = np.zeros_like(products)
        np.divide(products, squares, out=slopes, where=squares > 0.0)
        return slopes
