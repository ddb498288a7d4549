"""When a level of solid fraction passes a node, from the enthalpies of nodes at two instants.

The enthalpy of a node is the mean over its control volume. When the front of an isothermal change
stands at the node, half of that volume is still to freeze: the node's own solid fraction, and its
temperature, which rests on the plateau, say when the front enters and leaves the volume, not when
it passes the node. Where the gradient is steep the same is true of a freezing range.

So the level has come to a place when the node has the mean enthalpy that its control volume has
with the front there (`excess`), between the temperatures of the neighbours on either side of it.
Discrete fronts go by nodes in stairs: they hesitate when they reach a node and hurry when they
leave it. Therefore the passing is the mean of three: half of when the front is at the node, a
quarter each of when it enters and when it leaves the control volume. Within a step of implicit
Euler all enthalpies fall linearly, and the time is found where the two agree, so that it also holds
when a front passes several nodes in one step.

Near the liquidus of an alloy the profile bends within a cell, with the heat that freezes the first
solid. Straight lines to the neighbours make the front late there; the temperature of the node alone
makes it early by more where half freezes within 1 K: by 4 s in place of 2 s of 19 s at the
insulated end of ten cells with k = 0.9, where melt rests within 1.5 mK of its liquidus for 5 s.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.foundry.front.control_volumes import ControlVolumes
from castx.foundry.front.excess import PLACES, Excess, Parts, Step, narrowed
from castx.foundry.front.gradients import midpoint_gradients
from castx.foundry.front.levels import FreezingCurve, Level

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh

ROUNDING = 1e-12
"""Share of an excess that counts as none."""
SETTLED = 1e-11
"""Share of a step to which passing is known where the excess has a jump."""
MOST_TRIALS = 60
ALL_LIQUID = 1e-6
"""Weight of a liquid cell in a gradient that is seen from the solid."""

REACH = 3.0
"""Difference from T*, in differences between neighbours, beyond which nothing passes."""


@dataclass(frozen=True)
class Passage:
    """Passages of a step, the front of each level at each of `PLACES`.

    Attributes:
        frozen: nodes that it passed on cooling, (levels, places, nodes).
        remelted: nodes that it passed on heating.
        share: of the step that had gone by, where `frozen`.
    """

    frozen: BoolArray
    remelted: BoolArray
    share: FloatArray


class Front:
    """The fronts in one body.

    Args:
        body: the body.
        curve: enthalpy of its material.
        levels: of solid fraction, whose passing is noted.
        volumes: control volumes of the body.
    """

    def __init__(
        self,
        body: BodyMesh,
        curve: FreezingCurve,
        levels: Sequence[Level],
        volumes: ControlVolumes,
    ) -> None:
        self._curve = curve
        # Where all freezes at one temperature they are the same one, which is followed once.
        self._levels = tuple(dict.fromkeys(levels))
        self._which = [self._levels.index(level) for level in levels]
        self._volumes = volumes
        self._cell_nodes = self._volumes.cell_nodes
        self._positions = body.points
        self._gradients, self._sizes = midpoint_gradients(body.nodes, body.points[self._cell_nodes])
        self._excess = Excess(curve, self._levels, self._volumes, self._sizes)
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
        weighted = (self._sizes[:, None] * slopes)[cells]
        normal = volumes.added([volumes.at_nodes(index, column) for column in weighted.T]).T
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        normal = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
        own = self._cell_nodes[index]
        away = self._positions[self._cell_nodes[cells]] - self._positions[own][:, None]
        others = np.einsum("pbk,pk->pb", away, normal[own])
        points = np.einsum("pqb,pb->pq", volumes.shapes[corner], others)
        width = np.sqrt(12.0 * volumes.means(index, points**2))
        return Parts(index, own, self._cell_nodes[cells], points, others, width[own])

    def passed(self, enthalpy: FloatArray) -> BoolArray:
        """Return the nodes that each level has passed at enthalpies at rest; collective.

        Args:
            enthalpy: of the nodes, (nodes,) [J/m³].

        Returns:
            (levels, places, nodes).
        """
        rest = Step(enthalpy, enthalpy)
        parts = [self.parts(rest)] * (len(self._levels) * len(PLACES))
        return np.asarray(self._excess.at(rest, 0.0, parts) <= 0.0)[self._which]

    def passage(self, step: Step, parts: Parts, passed: BoolArray) -> Passage:
        """Return the passages of a step; collective.

        Args:
            step: enthalpies.
            parts: all control volumes in this step.
            passed: nodes that had been passed before, (levels, places, nodes).
        """
        near = np.repeat(self._near(step)[:, None], len(PLACES), axis=1)
        here = [of for one in near[:, 0] for of in [parts.of(one)] * len(PLACES)]
        temperature = self._curve.temperature(step.end)
        clear = np.stack([temperature - level.temperature for level in self._levels])
        last = np.broadcast_to(clear[:, None], near.shape)
        if self._comm.allreduce(bool(near.any()), MPI.LOR):
            last = np.where(near, self._excess.at(step, 1.0, here), last)
        which = self._which
        frozen, remelted = ~passed & (last <= 0.0)[which], passed & (last > 0.0)[which]
        wanted = np.zeros(near.shape, dtype=bool)
        np.logical_or.at(wanted, which, frozen & near[which])
        share = np.zeros(near.shape)
        if self._comm.allreduce(bool(wanted.any()), MPI.LOR):
            here = narrowed(here, wanted.reshape(len(here), -1))
            first = self._excess.at(step, 0.0, here)
            share = self._share(step, wanted & (first > 0.0), first, last, here)
        return Passage(frozen, remelted, share[which])

    def _near(self, step: Step) -> BoolArray:
        """Return the nodes that each level may pass, (levels, nodes); collective.

        The control volume of a node takes at most three quarters of its temperature from others, so
        that a node farther from T* than three times the differences in its cells has not got there.
        """
        ends = np.stack([self._curve.temperature(step.start), self._curve.temperature(step.end)])
        around = ends[:, self._cell_nodes]
        low, high = around.min(axis=(0, 2)), around.max(axis=(0, 2))
        reach = REACH * (high - low)
        sums = []
        for level in self._levels:
            near = (level.temperature >= low - reach) & (level.temperature <= high + reach)
            cells, corners = np.nonzero(np.broadcast_to(near[:, None], self._cell_nodes.shape))
            sums.append(self._volumes.at_nodes((cells, corners), np.ones(len(cells))))
        return np.asarray(self._volumes.added(sums) > 0.0)

    def _share(
        self,
        step: Step,
        nodes: BoolArray,
        first: FloatArray,
        last: FloatArray,
        parts: Sequence[Parts],
    ) -> FloatArray:
        """Return the share of the step at which the excess vanishes, by the Illinois rule.

        M. Dowell and P. Jarratt, A modified regula falsi method, BIT 11 (1971) 168-174.
        """
        low, high = np.zeros(nodes.shape), np.ones(nodes.shape)
        above, below = np.where(nodes, first, 1.0), np.where(nodes, last, 0.0)
        share, side = np.where(nodes, high, 0.0), np.zeros(nodes.shape)
        for _ in range(MOST_TRIALS):
            unsettled = nodes & (high - low > SETTLED) & (below < 0.0)
            if not self._comm.allreduce(bool(unsettled.any()), MPI.LOR):
                break
            share = np.where(unsettled, low + (high - low) * above / (above - below), share)
            parts = narrowed(parts, unsettled.reshape(len(parts), nodes.shape[-1]))
            found = self._excess.after(step, share, parts)
            up, down = unsettled & (found > 0.0), unsettled & (found <= 0.0)
            nodes = nodes & (np.abs(found) > ROUNDING * np.abs(first - last))
            below[up & (side > 0.0)] *= 0.5
            above[down & (side < 0.0)] *= 0.5
            low[up], above[up], side[up] = share[up], found[up], 1.0
            high[down], below[down], side[down] = share[down], found[down], -1.0
        return share

    def gradient(
        self, step: Step, frozen: BoolArray, share: FloatArray, parts: Parts
    ) -> FloatArray:
        """Return |∇T| at the nodes that a level passes, at that moment [K/m]; collective.

        It is interpolated between the ends of the step, and seen from the solid: the gradient jumps
        at the front of an isothermal change, so cells count with their solid fraction at either
        end, and liquid ones only where there is nothing else.

        Args:
            step: enthalpies.
            frozen: those nodes, (nodes,).
            share: of the step at which it passes them, (nodes,).
            parts: all control volumes in this step.
        """
        parts = parts.of(frozen)
        sums = []
        gone = share[parts.nodes]
        for enthalpy, near in ((step.start, 1.0 - gone), (step.end, gone)):
            gradients = self._gradients[parts.index[0]]
            steep, solid = seen_from_solid(self._curve, gradients, enthalpy[parts.corners])
            weights = near * self._sizes[parts.index[0]] * (solid + ALL_LIQUID)
            sums += [self._volumes.at_nodes(parts.index, values)
                     for values in (weights * steep, weights)]  # fmt: skip
        added = self._volumes.added(sums)
        total, counted = added[::2].sum(axis=0), added[1::2].sum(axis=0)
        means: FloatArray = np.full_like(total, np.nan)
        np.divide(total, counted, out=means, where=frozen)
        return means


def seen_from_solid(
    curve: FreezingCurve, gradients: FloatArray, enthalpy: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return |∇T| [K/m] and solid fraction of cells, each (cells,).

    Args:
        curve: of the material.
        gradients: of the shape functions, (cells, corners, dimension) [1/m].
        enthalpy: at the corners, (cells, corners) [J/m³].
    """
    slopes = np.einsum("pak,pa->pk", gradients, curve.temperature(enthalpy))
    return np.linalg.norm(slopes, axis=1), curve.solid_fraction(enthalpy).mean(axis=1)
