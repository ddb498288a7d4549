"""The pipe of a body: liquid that its highest places lose to feed the freezing below.

A step of a pool that is open to a feeder lacks Σ V_i β Δf_i of its nodes below the limit of mass
feeding; that empties its highest nodes along gravity, the last ones in part.
Where melt flows through the mush the mechanics says what feeders supply (`castx.mechanics.mush`),
in place of that sum, and what is empty freezes and lacks β there too, which is taken off: so in the
end the pipe of a sound casting has s of its volume either way. Nodes of one height
fall together. What is empty lacks nothing and is no liquid that joins others; liquid beside it is
open to the feeders to which it was. The metal of the heat equation stays where it is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.domain.measures import nodal_sum, nodal_volumes
from castx.foundry.pools.draining import Draining, drained
from castx.foundry.pools.heights import Heights, Places
from castx.foundry.pools.joined_nodes import NodeRegions
from castx.foundry.pools.supplied import SuppliedMelt
from castx.stateful import Arrays, Saved

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh


NOTHING: Mapping[str, float] = MappingProxyType({})


@dataclass(frozen=True)
class PipedMetal:
    """A body whose feeders sink, as its pipe sees it.

    Attributes:
        contraction: β = (ρ_s - ρ_l)/ρ_l.
        limit: solid fraction below which metal flows in mass.
        up: direction against gravity, of length 1.
        feeders: their names.
        flows: whether the mechanics says what they supply.
    """

    contraction: float
    limit: float
    up: tuple[float, ...]
    feeders: tuple[str, ...]
    flows: bool = False


@dataclass(frozen=True, eq=False)
class Pooled:
    """The pools of a body at the start of a step that are open to a feeder.

    Attributes:
        of_node: number of the pool of each local node, -1: of none that is open, (nodes,).
        open_to: whether each pool is open to each feeder, (pools, feeders).
    """

    of_node: IntArray
    open_to: BoolArray


class BodyPipe:
    """The pipe of one body, followed from step to step.

    Args:
        body: its mesh.
        model: geometric model.
        metal: what flows.
    """

    def __init__(self, body: BodyMesh, model: str, metal: PipedMetal) -> None:
        self._body, self._metal, self._comm = body, metal, body.mesh.comm
        self._regions = NodeRegions(body)
        self._volumes = nodal_volumes(body, model)
        self._owned = slice(len(self._volumes))
        self._heights = Heights(body, metal.up)
        self.begin()

    def begin(self) -> None:
        """Fill the body with new metal."""
        nodes, feeders = len(self._body.parent_vertices), len(self._metal.feeders)
        self._fraction: FloatArray = np.full(nodes, np.nan)
        self._filled: FloatArray = np.ones(nodes)
        self.emptied: FloatArray = np.zeros(nodes)
        self._beside: BoolArray = np.zeros((nodes, feeders), dtype=bool)
        self._levels: FloatArray = np.full(feeders, np.nan)
        self._above: FloatArray = np.full(nodes, np.nan)
        self._unfed = 0.0
        self._supplied = SuppliedMelt(self._metal.feeders) if self._metal.flows else None

    def update(
        self,
        fraction: FloatArray,
        feeders: Mapping[str, BoolArray],
        supplied: Mapping[str, float] = NOTHING,
    ) -> None:
        """Follow the pipe to the end of a step; collective.

        What melts and freezes again lacks nothing the second time.

        Args:
            fraction: solid fraction of the nodes, ghosts included, (nodes,).
            feeders: whether the nodes lie on each of them, by name.
            supplied: what each of them has supplied so far [m³ of liquid], by name, of metal that
                flows.
        """
        known = [feeders[name] for name in self._metal.feeders]
        surfaces = np.array(known, dtype=bool).reshape(len(known), len(fraction)).T
        self._begin_levels(surfaces)
        if np.isnan(self._fraction).any():
            self._fraction = fraction.copy()
            return
        reached = np.maximum(fraction, self._fraction)
        goes_on = bool((reached > self._fraction).any())
        if self._supplied is not None:
            self._supplied.take_over(supplied, self._lacking_where_empty(reached))
            goes_on |= bool((self._supplied.owed > 0.0).any())
        if not self._comm.allreduce(goes_on, MPI.LOR):
            return
        pools = self._pools(surfaces)
        self._feed(pools, reached, surfaces)
        self._fraction = reached

    def _begin_levels(self, surfaces: BoolArray) -> None:
        """Take the heights of surfaces that feed from now on as the levels of their feeders."""
        if not np.isnan(self._levels).any():
            return
        own = [self._heights.values[nodes].max(initial=-np.inf) for nodes in surfaces.T]
        highest = np.max(self._comm.allgather(np.array(own)), axis=0)
        self._levels = np.where(
            np.isnan(self._levels) & np.isfinite(highest), highest, self._levels
        )

    def _pools(self, surfaces: BoolArray) -> Pooled:
        """Return the open pools of the last state; collective."""
        liquid = (self._fraction < self._metal.limit) & (self._filled > 0.0)
        count, region = self._regions.find(liquid)
        source = self._beside & (self._filled <= 0.0)[:, None]
        near = self._regions.neighbours_of(source) | self._beside | surfaces
        touching = np.zeros((count, near.shape[1]), dtype=np.int32)
        np.maximum.at(touching, region[liquid], near[liquid].astype(np.int32))
        self._comm.Allreduce(MPI.IN_PLACE, touching, op=MPI.MAX)
        open_to = touching > 0
        fed = open_to.any(axis=1)
        number = np.append(np.where(fed, np.cumsum(fed) - 1, -1), -1).astype(np.int32)
        return Pooled(number[region], open_to[fed])

    def _feed(self, pools: Pooled, reached: FloatArray, surfaces: BoolArray) -> None:
        """Empty the highest nodes of the open pools; collective."""
        own, count = self._owned, len(pools.open_to)
        pool = pools.of_node[own]
        start = self._fraction[own]
        end = np.where(pool >= 0, np.minimum(reached[own], self._metal.limit), start)
        metal = self._volumes * self._filled[own]
        liquid, freezing = metal * (1.0 - start), metal * (end - start)
        share, mean = np.ones(len(metal)), np.ones(len(metal))
        totals, held = self._sums_of_pools(pool, count, freezing, liquid)
        levels = np.full((count, len(self._metal.feeders)), np.nan)
        beta, keys = self._metal.contraction, self._heights.keys[own]
        lacks = beta * totals
        if self._supplied is not None:
            lacks = self._supplied.ask(pools.open_to, totals, held)
        columns = self._heights.highest(pool, liquid, freezing, lacks)
        tops = self._tops(pools, surfaces)
        for number in range(count):
            feeders, places = pools.open_to[number], Places.of(columns, number)
            rest = float(lacks[number] / beta - places.freezing.sum())
            rest = rest if self.flows else max(rest, 0.0)
            found = drained(places.liquid, places.freezing, rest, beta)
            if self._supplied is not None:
                self._supplied.pay(number, self._given(places, found))
            levels[number, feeders] = level = places.level(found.left, tops[number])
            self._above[pools.of_node == number] = level
            here = np.flatnonzero(pool == number)
            here, place = places.among(here, keys[here])
            share[here], mean[here] = found.left[place], found.mean[place]
        self._book(metal, (start, end, reached[own]), share, mean)
        self._mark(pools, surfaces, share < 1.0)
        if count:
            self._levels = np.fmin(self._levels, _highest_of(levels))

    def _sums_of_pools(self, pool: IntArray, count: int, *values: FloatArray) -> FloatArray:
        """Return sums over the nodes of each pool, (values, pools); collective."""
        inside = pool >= 0
        sums = np.array([np.bincount(pool[inside], own[inside], count) for own in values])
        return np.asarray(self._comm.allreduce(sums, op=MPI.SUM))

    def _given(self, places: Places, found: Draining) -> float:
        """Return the volume that flows out of places, and the lack of what is empty [m³]."""
        frozen = places.freezing @ found.mean
        lost = places.liquid.sum() - found.left @ (places.liquid - places.freezing) - frozen
        return float(lost + self._metal.contraction * (places.freezing.sum() - frozen))

    def _lacking_where_empty(self, reached: FloatArray) -> FloatArray:
        """Return the lack of emptied metal that freezes, by feeder [m³], (feeders,); collective.

        Args:
            reached: solid fraction of the local nodes at the end of the step, (nodes,).
        """
        empty = ((1.0 - self._filled) * (reached - self._fraction))[self._owned]
        marks = self._beside[self._owned].astype(np.float64)
        marks /= np.maximum(marks.sum(axis=1, keepdims=True), 1.0)
        lacking = self._metal.contraction * (self._volumes * empty) @ marks
        return np.asarray(self._comm.allreduce(lacking, op=MPI.SUM))

    def _tops(self, pools: Pooled, surfaces: BoolArray) -> list[float]:
        """Return the height up to which each open pool is full [m]; collective.

        Of one that has not fallen yet it is the highest place of its feeders.
        """
        heights = np.stack([self._above, np.where(surfaces.any(1), self._heights.values, np.nan)])
        tops: FloatArray = np.full((2, len(pools.open_to)), -np.inf)
        for k, values in enumerate(heights):
            here = (pools.of_node >= 0) & np.isfinite(values)
            np.maximum.at(tops[k], pools.of_node[here], values[here])
        self._comm.Allreduce(MPI.IN_PLACE, tops, op=MPI.MAX)
        fallen, surface = tops
        others = np.array([np.nanmax(self._levels[feeders]) for feeders in pools.open_to])
        begun = np.where(np.isfinite(surface), surface, others)
        return [float(top) for top in np.where(np.isfinite(fallen), fallen, begun)]

    def _book(
        self,
        metal: FloatArray,
        fractions: tuple[FloatArray, FloatArray, FloatArray],
        share: FloatArray,
        mean: FloatArray,
    ) -> None:
        """Book the liquid lost by the owned nodes and the unfed demand; collective."""
        start, end, reached = fractions
        lost = metal * (1.0 - start - share * (1.0 - end) - mean * (end - start))
        emptied, filled = self.emptied.copy(), self._filled.copy()
        emptied[self._owned] += np.where(share < 1.0, lost, 0.0) / self._volumes
        filled[self._owned] *= share
        self.emptied, self._filled = self._everywhere(emptied), self._everywhere(filled)
        lacking = share * (reached - end)
        if self.flows:
            lacking = lacking + mean * (end - start)
        unfed = self._metal.contraction * float(metal @ lacking)
        if self.flows:
            unfed -= float(lost[share < 1.0].sum())
        self._unfed += self._comm.allreduce(unfed, op=MPI.SUM)

    def _mark(self, pools: Pooled, surfaces: BoolArray, fallen: BoolArray) -> None:
        """Note the feeders to which emptied nodes are open; collective."""
        found: FloatArray = self._beside.astype(np.float64)
        here = np.flatnonzero(fallen)
        marks = pools.open_to[pools.of_node[here]] | surfaces[here]
        found[here] = np.maximum(found[here], marks)
        for feeder in range(found.shape[1]):
            self._beside[:, feeder] = self._everywhere(found[:, feeder]) > 0.0

    def _everywhere(self, values: FloatArray) -> FloatArray:
        """Return the values of the owned nodes at all local ones; collective."""
        own = values.copy()
        own[self._owned.stop :] = 0.0
        return nodal_sum(self._body, own)

    def volume(self) -> float:
        """Return the volume of the pipe so far [m³]; collective."""
        own = float(self._volumes @ self.emptied[self._owned])
        return float(self._comm.allreduce(own, op=MPI.SUM))

    @property
    def flows(self) -> bool:
        """Whether the mechanics says what the feeders supply."""
        return self._metal.flows

    @property
    def unfed(self) -> float:
        """Volume of feeding demand that no feeder has supplied [m³]."""
        return self._unfed

    @property
    def levels(self) -> dict[str, float]:
        """Height of the liquid of each feeder along gravity [m]; not a number: it has none yet."""
        levels = (float(level) for level in self._levels)
        return dict(zip(self._metal.feeders, levels, strict=True))

    def saved(self) -> dict[str, Saved]:
        """Return the state after the last step."""
        numbering = self._body.node_numbering
        nodal = {
            "fraction": self._fraction, "filled": self._filled, "emptied": self.emptied,
            "beside": self._beside.astype(np.float64), "above": self._above,
        }  # fmt: skip
        found = {name: Saved(values, numbering) for name, values in nodal.items()}
        whole = {"levels": self._levels, "unfed": np.array(self._unfed)}
        if self._supplied is not None:
            whole |= self._supplied.saved()
        bodies = (self._body.name,)
        return found | {name: Saved(values, bodies=bodies) for name, values in whole.items()}

    def restore(self, arrays: Arrays) -> None:
        """Go on with the pipe of an earlier part of the run.

        A feeder that was not there begins now.
        """
        if arrays["beside"].shape[1] != len(self._metal.feeders):
            return
        self._fraction, self._filled = arrays["fraction"].copy(), arrays["filled"].copy()
        self.emptied, self._beside = arrays["emptied"].copy(), arrays["beside"] > 0.5
        self._levels, self._unfed = np.array(arrays["levels"]), float(arrays["unfed"])
        self._above = arrays["above"].copy()
        if self._supplied is not None:
            self._supplied.restore(arrays)


def _highest_of(levels: FloatArray) -> FloatArray:
    """Return the highest level of each feeder in its pools, not a number without, (feeders,)."""
    highest = np.where(np.isnan(levels), -np.inf, levels).max(axis=0, initial=-np.inf)
    return np.where(np.isfinite(highest), highest, np.nan)
