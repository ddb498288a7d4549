"""The pools of one body, followed from step to step.

A pool is a set of nodes with solid fractions below a limit, joined by edges of cells with both ends
below it. It is isolated when none of its nodes lies on a surface that feeds.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray, LongArray
from castx.domain.measures import nodal_volumes
from castx.foundry.pools.cut_off import Metal, cut_off, liquid_at
from castx.foundry.pools.heritage import Heritage
from castx.foundry.pools.joined_nodes import NodeRegions
from castx.foundry.pools.pool import Isolation, Pool
from castx.stateful import Arrays, Saved, number

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh

TIE = 1e-6
"""Difference of solid fractions, and of shares of a step, that counts as none."""


class BodyPools:
    """The pools of one body.

    Args:
        body: its mesh.
        model: geometric model.
        limit: solid fraction below which metal is liquid here.
    """

    def __init__(self, body: BodyMesh, model: str, limit: float) -> None:
        self._comm = body.mesh.comm
        self._limit = limit
        self._regions = NodeRegions(body)
        self._volumes = nodal_volumes(body, model)
        self._owned = slice(len(self._volumes))
        self._points, self._original = body.points[self._owned], body.original_nodes[self._owned]
        self._numbering = body.node_numbering
        self._of_node: LongArray = np.zeros(len(body.parent_vertices), dtype=np.int64)
        self._fraction: FloatArray = np.ones(len(body.parent_vertices))
        self._time = np.nan
        self._pools: dict[int, Pool] = {}
        self._following = 1

    @property
    def numbers(self) -> LongArray:
        """Number of the pool of each local node, 0: none, (nodes,)."""
        return self._of_node

    @property
    def known(self) -> list[Pool]:
        """The pools that there are or that were isolated when they ended, by their numbers."""
        return [self._pools[key] for key in sorted(self._pools)]

    def begin(self) -> None:
        """Forget all pools: the body is new."""
        self._of_node[:], self._fraction[:] = 0, 1.0
        self._time = np.nan
        self._pools, self._following = {}, 1

    def update(self, time: float, fraction: FloatArray, feeds: BoolArray) -> None:
        """Follow the pools to the end of a step; collective.

        Args:
            time: there [s].
            fraction: solid fraction of the nodes, ghosts included, (nodes,).
            feeds: whether the nodes lie on a surface that feeds, ghosts included, (nodes,).
        """
        count, region = self._regions.find(fraction < self._limit)
        living = [pool.number for pool in self._pools.values() if pool.ended is None]
        if count or living:
            liquid = self._volumes * (1.0 - fraction[self._owned])
            shares = self._shares(region, liquid)
            heritage = Heritage.of(shares, count, living, self._following)
            self._end(heritage.gone, time, fraction)
            self._inherit(heritage, time)
            self._measure(heritage.numbers, region, fraction, feeds, time)
            numbers = np.array([*heritage.numbers, 0])  # region -1 is the last one
            self._of_node = numbers[region]
        self._fraction, self._time = fraction.copy(), time

    def _shares(self, region: IntArray, liquid: FloatArray) -> dict[tuple[int, int], float]:
        """Return the liquid that was in a pool and is in a region, by both; collective."""
        before, now = self._of_node[self._owned], region[self._owned]
        both = (before > 0) & (now >= 0)
        pairs, which = np.unique(
            np.column_stack([before[both], now[both]]), axis=0, return_inverse=True
        )
        sums = np.bincount(which.ravel(), liquid[both], len(pairs))
        found: dict[tuple[int, int], float] = {}
        for of_rank in self._comm.allgather((pairs.tolist(), sums.tolist())):
            for (pool, to), volume in zip(*of_rank, strict=True):
                found[pool, to] = found.get((pool, to), 0.0) + volume
        return found

    def _end(self, gone: Sequence[int], time: float, fraction: FloatArray) -> None:
        """Note the end of pools of which nothing is left, when their last node passed the limit."""
        if not gone:
            return
        before, now = self._fraction[self._owned], fraction[self._owned]
        fallen = np.isin(self._of_node[self._owned], gone)
        share = np.zeros(len(now))
        share[fallen] = (self._limit - before[fallen]) / (now[fallen] - before[fallen])
        last, places = self._last(self._of_node[self._owned], gone, share)
        for index, pool in enumerate(gone):
            if self._pools[pool].isolation is None:
                del self._pools[pool]  # it was fed to the end
                continue
            end = self._time + float(last[index]) * (time - self._time)
            self._pools[pool] = replace(self._pools[pool], ended=end, place=tuple_of(places[index]))

    def _inherit(self, heritage: Heritage, time: float) -> None:
        """Note the pools that are new, and those that have become part of another one."""
        for pool, parent in heritage.parents.items():
            self._pools[pool] = Pool(pool, time, parent)
            if parent is not None:
                origin = self._pools[parent]
                self._pools[parent] = replace(origin, children=(*origin.children, pool))
        self._following += len(heritage.parents)
        for pool, others in heritage.merged.items():
            parts = [self._pools.pop(other) for other in others]
            self._pools[pool] = self._pools[pool].with_merged(parts)

    def _measure(
        self,
        numbers: Sequence[int],
        region: IntArray,
        fraction: FloatArray,
        feeds: BoolArray,
        time: float,
    ) -> None:
        """Note which pools are isolated, and where each has its lowest solid fraction."""
        count, own = len(numbers), region[self._owned]
        touching = np.zeros(count, dtype=np.int32)
        np.maximum.at(touching, own[own >= 0], feeds[self._owned][own >= 0].astype(np.int32))
        self._comm.Allreduce(MPI.IN_PLACE, touching, op=MPI.MAX)
        _, places = self._last(own, range(count), -fraction[self._owned])
        metal = Metal(self._regions, self._volumes, self._limit, self._fraction, fraction)
        for index, pool in enumerate(numbers):
            isolation = self._pools[pool].isolation
            if touching[index]:
                isolation = None
            elif isolation is None:
                # Before the first state all counts as frozen, so that nothing was fed.
                share = cut_off(metal, region == index, feeds)
                at = time if share == 1.0 else self._time + share * (time - self._time)
                isolation = self._isolation(at, liquid_at(metal, index, region, share))
            self._pools[pool] = replace(
                self._pools[pool], isolation=isolation, place=tuple_of(places[index])
            )

    def _isolation(self, time: float, liquid: FloatArray) -> Isolation:
        """Return the isolation of a pool at a time [s] with liquid of its nodes; collective."""
        sums = np.array([liquid.sum(), *(liquid @ self._points)])
        self._comm.Allreduce(MPI.IN_PLACE, sums, op=MPI.SUM)
        return Isolation(time, tuple_of(sums[1:] / sums[0]), float(sums[0]))

    def _last(
        self, group: LongArray | IntArray, groups: Sequence[int], key: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the largest key in each group and the place of that node; collective.

        Of nodes with the same key it is the lowest in the mesh before it was distributed.

        Args:
            group: of the owned nodes.
            groups: those asked for.
            key: of the owned nodes, of the order of one.
        """
        largest = np.full(len(groups), -np.inf)
        order = np.full(len(groups), np.iinfo(np.int64).max)
        places = np.zeros((len(groups), self._points.shape[1]))
        members = [np.flatnonzero(group == wanted) for wanted in groups]
        largest[:] = [key[nodes].max(initial=-np.inf) for nodes in members]
        self._comm.Allreduce(MPI.IN_PLACE, largest, op=MPI.MAX)
        for index, nodes in enumerate(members):
            tied = nodes[key[nodes] >= largest[index] - TIE]
            order[index] = self._original[tied].min(initial=order[index])
            members[index] = tied
        self._comm.Allreduce(MPI.IN_PLACE, order, op=MPI.MIN)
        for index, nodes in enumerate(members):
            places[index] = self._points[nodes[self._original[nodes] == order[index]]].sum(axis=0)
        self._comm.Allreduce(MPI.IN_PLACE, places, op=MPI.SUM)
        return largest, places

    def saved(self) -> dict[str, Saved]:
        """Return the pools of the nodes and their solid fractions after the last step."""
        return {
            "pool": Saved(self._of_node, self._numbering),
            "fraction": Saved(self._fraction, self._numbering),
            "time": number(self._time),
        }

    def notes(self) -> dict[str, Any]:
        """Return the records of the pools, as JSON knows them."""
        return {"following": self._following, "pools": [pool.notes() for pool in self.known]}

    def restore(self, arrays: Arrays, notes: Mapping[str, Any]) -> None:
        """Go on with the pools of an earlier part of the run."""
        self._of_node = np.asarray(arrays["pool"], dtype=np.int64)
        self._fraction, self._time = arrays["fraction"].copy(), float(arrays["time"])
        pools: Iterator[Pool] = map(Pool.of, notes["pools"])
        self._pools, self._following = {pool.number: pool for pool in pools}, notes["following"]


def tuple_of(place: FloatArray) -> tuple[float, ...]:
    """Return coordinates as numbers of Python."""
    return tuple(float(x) for x in place)
