"""When a level of solid fraction passes a node, from the enthalpies of nodes at two instants.

The enthalpy of a node is the mean over its control volume. When the front of an isothermal change
stands at the node, half of that volume is still to freeze: the node's own solid fraction, and its
temperature, which rests on the plateau, say when the front enters and leaves the volume, not when
it passes the node. Where the gradient is steep the same is true of a freezing range.

So the front is a plane across the temperature gradient, at T*, the temperature of the level; on
either side of it the temperature changes linearly to those of the neighbours. The level has come to
a place when the node has the mean enthalpy that its control volume has with the front there,
    H_mean = 1/V ∫ H(T* + G± s) dV,  s the distance from the front, G+ where s > 0, G- where s < 0.
Discrete fronts go by nodes in stairs: they hesitate when they reach a node and hurry when they
leave it. Therefore the passing is the mean of three: half of when the front is at the node, a
quarter each of when it enters and when it leaves the control volume. Within a step of implicit
Euler all enthalpies fall linearly, and the time is found where the two agree, so that it also holds
when a front passes several nodes in one step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Protocol

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.results.freezing.control_volumes import ControlVolumes
from castx.results.freezing.gradients import midpoint_gradients

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh

COLDEST, HOTTEST = -273.15, 1e4
"""Temperatures between which every metal freezes [°C]."""

ROUNDING = 1e-12
"""Difference of solid fraction, and share of a step, that counts as none."""
MOST_TRIALS = 60
ALL_LIQUID = 1e-6
"""Weight of a liquid cell in a gradient that is seen from the solid."""

PLACES, WEIGHTS = (-0.5, 0.0, 0.5), (0.25, 0.5, 0.25)
"""Places of the front, in widths of the control volume from its node, and their weights."""

NEAR = 0.1
"""Distance from the front, in widths of the control volume, from which a node shows a gradient."""
REACH = 3.0
"""Difference from T*, in differences between neighbours, beyond which nothing passes."""


class FreezingCurve(Protocol):
    """The part of a material's enthalpy curve that is needed here."""

    def enthalpy(self, temperature: FloatArray) -> FloatArray:
        """Return enthalpies per volume [J/m³] at temperatures [°C]."""

    def temperature(self, enthalpy: FloatArray) -> FloatArray:
        """Return temperatures [°C] at enthalpies per volume [J/m³]."""

    def solid_fraction(self, enthalpy: FloatArray) -> FloatArray:
        """Return solid fractions at enthalpies per volume [J/m³]."""


@dataclass(frozen=True)
class Level:
    """A solid fraction on the enthalpy curve of a material.

    Attributes:
        temperature: at which it is reached [°C].
        cold, hot: enthalpies at the ends of the plateau of this temperature [J/m³], equal if there
            is none.
    """

    temperature: float
    cold: float
    hot: float

    @classmethod
    def of(cls, curve: FreezingCurve, fraction: float) -> Level:
        """Return the level of a solid fraction; 0 is the liquidus, 1 the solidus."""
        least = max(min(fraction, 1.0 - ROUNDING), ROUNDING)
        reached = highest(curve, lambda enthalpy: curve.solid_fraction(enthalpy) >= least)
        temperature = float(curve.temperature(np.array(reached)))
        cold = highest(curve, lambda enthalpy: curve.temperature(enthalpy) < temperature)
        hot = highest(curve, lambda enthalpy: curve.temperature(enthalpy) <= temperature)
        return cls(temperature, cold, hot)

    def enthalpy_beside(
        self, curve: FreezingCurve, temperature: FloatArray, distance: FloatArray
    ) -> FloatArray:
        """Return enthalpies of points beside a front [J/m³].

        Args:
            curve: of the material.
            temperature: of the points [°C].
            distance: from the front, positive ahead of it; it decides at the front's temperature.
        """
        enthalpy = curve.enthalpy(temperature)
        hotter = (temperature > self.temperature) | (
            (temperature == self.temperature) & (distance > 0.0)
        )
        return np.where(hotter, np.maximum(enthalpy, self.hot), np.minimum(enthalpy, self.cold))


def highest(curve: FreezingCurve, holds: Callable[[FloatArray], BoolArray]) -> float:
    """Return the highest enthalpy [J/m³] up to which something holds, by bisection."""
    low, high = (float(curve.enthalpy(np.array(bound))) for bound in (COLDEST, HOTTEST))
    while (middle := 0.5 * (low + high)) not in (low, high):
        low, high = (middle, high) if bool(holds(np.array(middle))) else (low, middle)
    return low


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
class Passage:
    """What passed in a step.

    Attributes:
        frozen: nodes that a level passed on cooling, (nodes,).
        remelted: nodes that it passed on heating.
        share: of the step that had gone by, where `frozen`.
    """

    frozen: BoolArray
    remelted: BoolArray
    share: FloatArray


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
        """Return the parts of those nodes (nodes,) alone."""
        kept = nodes[self.nodes]
        cells, corners = self.index
        return Parts(
            (cells[kept], corners[kept]),
            self.nodes[kept],
            self.corners[kept],
            self.points[kept],
            self.others[kept],
            self.width[kept],
        )


class Front:
    """The fronts in one body.

    Args:
        body: the body.
        curve: enthalpy of its material.
        axisymmetric: whether the first coordinate is a radius.
    """

    def __init__(self, body: BodyMesh, curve: FreezingCurve, axisymmetric: bool = False) -> None:
        self._curve = curve
        self._volumes = ControlVolumes(body, axisymmetric)
        self._cell_nodes = self._volumes.cell_nodes
        self._positions = body.points
        self._gradients, self._sizes = midpoint_gradients(body.nodes, body.points[self._cell_nodes])
        self._comm: MPI.Intracomm = body.mesh.comm

    def parts(self, step: Step) -> Parts:
        """Return the control volumes of all nodes, along the gradient of a step; collective.

        The gradient is that of the enthalpy, which has the direction of the temperature's and is
        not lost where several nodes are on a plateau.
        """
        volumes = self._volumes
        nodes = np.arange(len(self._positions))
        middle = step.after(np.full(nodes.size, 0.5), nodes)
        slopes = np.einsum("cak,ca->ck", self._gradients, middle[self._cell_nodes])
        index = volumes.around(np.ones(nodes.size, dtype=bool))
        cells, corner = index
        normal = np.column_stack(
            [volumes.added(index, (self._sizes * slope)[cells]) for slope in slopes.T]
        )
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        normal = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
        own = self._cell_nodes[index]
        away = self._positions[self._cell_nodes[cells]] - self._positions[own][:, None]
        others = np.einsum("pbk,pk->pb", away, normal[own])
        points = np.einsum("pqb,pb->pq", volumes.shapes[corner], others)
        width = np.sqrt(12.0 * volumes.means(index, points**2))
        return Parts(index, own, self._cell_nodes[cells], points, others, width[own])

    def excess(
        self, level: Level, place: float, step: Step, share: FloatArray, parts: Parts
    ) -> FloatArray:
        """Return by how much the enthalpy exceeds that with the front at a place; collective.

        Args:
            level: of solid fraction.
            place: of the front from the node, in widths of the control volume.
            step: enthalpies.
            share: of the step, (nodes,).
            parts: the control volumes of the nodes asked for; the others have no meaning.

        Returns:
            (nodes,) [J/m³].
        """
        gone = share[parts.nodes]
        shift = place * parts.width
        at_corners = step.after(gone[:, None], parts.corners)
        rise = self._curve.temperature(at_corners) - level.temperature
        ahead, behind = self._slopes(parts, rise, parts.others - shift[:, None])
        distance = parts.points - shift[:, None]
        slope = np.where(distance > 0.0, ahead[parts.nodes, None], behind[parts.nodes, None])
        temperature = level.temperature + slope * distance
        values = level.enthalpy_beside(self._curve, temperature, distance)
        nodes = np.arange(share.size)
        return step.after(share, nodes) - self._volumes.means(parts.index, values)

    def _slopes(
        self, parts: Parts, rise: FloatArray, distance: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the gradients ahead of and behind the front, least squares through it; collective.

        Args:
            parts: control volumes.
            rise: temperatures of the nodes of their cells over the front's, (parts, corners) [K].
            distance: of these nodes from the front [m].
        """
        others = parts.corners != parts.nodes[:, None]
        sizes = self._sizes[parts.index[0], None]
        found = []
        for sign in (1.0, -1.0):
            counted = others & (sign * distance > NEAR * parts.width[:, None])
            products, squares = (
                self._volumes.added(parts.index, np.where(counted, sizes * terms, 0.0).sum(axis=1))
                for terms in (rise * distance, distance**2)
            )
            found.append(
                np.divide(products, squares, out=np.zeros_like(products), where=squares > 0.0)
            )
        return found[0], found[1]

    def passages(self, level: Level, step: Step, parts: Parts, passed: BoolArray) -> list[Passage]:
        """Return what a level passes in a step, for the front at each of `PLACES`; collective.

        Args:
            level: of solid fraction.
            step: enthalpies.
            parts: all control volumes in this step.
            passed: nodes that the level had passed before, (places, nodes).
        """
        near = self._near(level, step)
        none, whole = np.zeros(near.size), np.ones(near.size)
        parts = parts.of(near)
        clear = self._curve.temperature(step.end) - level.temperature
        found = []
        for place, before in zip(PLACES, passed, strict=True):
            excess = partial(self.excess, level, place, step)
            last = np.where(near, excess(whole, parts), clear)
            frozen, remelted = ~before & (last <= 0.0), before & (last > 0.0)
            first = np.where(frozen & near, excess(none, parts), 0.0)
            share = self._share(excess, frozen & near, first, last, parts)
            found.append(Passage(frozen, remelted, share))
        return found

    def _near(self, level: Level, step: Step) -> BoolArray:
        """Return the nodes that the level may pass; around the others all is on one side of it.

        Its control volume takes at most three quarters of its temperature from the other nodes, so
        that a node farther from T* than three times the differences in its cells has not got there.
        """
        ends = np.stack([self._curve.temperature(step.start), self._curve.temperature(step.end)])
        around = ends[:, self._cell_nodes]
        low, high = around.min(axis=(0, 2)), around.max(axis=(0, 2))
        reach = REACH * (high - low)
        near = (level.temperature >= low - reach) & (level.temperature <= high + reach)
        cells, corners = np.nonzero(np.broadcast_to(near[:, None], self._cell_nodes.shape))
        return self._volumes.added((cells, corners), np.ones(len(cells))) > 0.0

    def _share(
        self,
        excess: Callable[[FloatArray, Parts], FloatArray],
        nodes: BoolArray,
        first: FloatArray,
        last: FloatArray,
        parts: Parts,
    ) -> FloatArray:
        """Return the share of the step at which the excess vanishes, by the Illinois rule.

        M. Dowell and P. Jarratt, A modified regula falsi method, BIT 11 (1971) 168-174.
        """
        nodes = nodes & (first > 0.0)  # the others had passed when the step began
        low, high = np.zeros(nodes.size), np.ones(nodes.size)
        above, below = np.where(nodes, first, 1.0), np.where(nodes, last, 0.0)
        share, side = np.where(nodes, high, 0.0), np.zeros(nodes.size)
        for _ in range(MOST_TRIALS):
            unsettled = nodes & (high - low > ROUNDING) & (below < 0.0)
            if not self._comm.allreduce(bool(unsettled.any()), MPI.LOR):
                break
            share = np.where(unsettled, low + (high - low) * above / (above - below), share)
            found = excess(share, parts.of(unsettled))
            up, down = unsettled & (found > 0.0), unsettled & (found <= 0.0)
            below[up & (side > 0.0)] *= 0.5
            above[down & (side < 0.0)] *= 0.5
            low[up], above[up], side[up] = share[up], found[up], 1.0
            high[down], below[down], side[down] = share[down], found[down], -1.0
        return share

    def gradient(self, step: Step, passage: Passage, parts: Parts) -> FloatArray:
        """Return |∇T| at the nodes that a level passes, at that moment [K/m]; collective.

        It is interpolated between the ends of the step, and seen from the solid: the gradient jumps
        at the front of an isothermal change, so cells count with their solid fraction at either
        end, and liquid ones only where there is nothing else.
        """
        parts = parts.of(passage.frozen)
        share = passage.share[parts.nodes]
        total, counted = np.zeros((2, passage.share.size))
        for enthalpy, near in ((step.start, 1.0 - share), (step.end, share)):
            steep, solid = self._seen(enthalpy, parts)
            weights = near * self._sizes[parts.index[0]] * (solid + ALL_LIQUID)
            total += self._volumes.added(parts.index, weights * steep)
            counted += self._volumes.added(parts.index, weights)
        return np.divide(total, counted, out=np.full_like(total, np.nan), where=passage.frozen)

    def _seen(self, enthalpy: FloatArray, parts: Parts) -> tuple[FloatArray, FloatArray]:
        """Return |∇T| [K/m] and solid fraction of the cells of parts at an instant, (parts,)."""
        at_corners = enthalpy[parts.corners]
        slopes = np.einsum(
            "pak,pa->pk", self._gradients[parts.index[0]], self._curve.temperature(at_corners)
        )
        solid = self._curve.solid_fraction(at_corners).mean(axis=1)
        return np.linalg.norm(slopes, axis=1), solid
