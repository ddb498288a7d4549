"""When the last path from a pool to its feeders froze within a step, and its liquid at that time.

Of a step that ends long after it much of the pool has frozen too, which nothing fed.
"""

from __future__ import annotations

from typing import NamedTuple

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.foundry.pools.joined_nodes import NodeRegions

HALVES = 12
"""How often a step is halved to find when a pool was cut off."""


class Metal(NamedTuple):
    """Metal of a body over a step in which solid fractions change linearly.

    Attributes:
        regions: of nodes that are joined.
        volumes: of the owned nodes [m³], (owned nodes,).
        limit: solid fraction below which metal is liquid here.
        start: solid fraction of the nodes before the step, ghosts included, (nodes,).
        end: after it, likewise.
    """

    regions: NodeRegions
    volumes: FloatArray
    limit: float
    start: FloatArray
    end: FloatArray

    def fraction(self, share: float) -> FloatArray:
        """Return the solid fraction after a share of the step, exactly that of its end for one."""
        return self.end if share == 1.0 else self.start + share * (self.end - self.start)

    def liquid(self, share: float) -> FloatArray:
        """Return the volume of liquid of the owned nodes [m³], (owned nodes,)."""
        return self.volumes * (1.0 - self.fraction(share)[: len(self.volumes)])


def cut_off(metal: Metal, inside: BoolArray, feeds: BoolArray) -> float:
    """Return the share of a step at which the last path from a pool to its feeders froze.

    It is found by halves, and one where the pool was not fed before the step: as a part of an
    isolated one. Collective.

    Args:
        metal: of the body over the step.
        inside: the nodes of the pool at the end of the step, ghosts included, (nodes,).
        feeds: nodes on surfaces that feed, likewise.
    """
    if not metal.regions.join(inside, feeds, metal.start < metal.limit):
        return 1.0
    fed, free = 0.0, 1.0
    for _ in range(HALVES):
        share = 0.5 * (fed + free)
        if metal.regions.join(inside, feeds, metal.fraction(share) < metal.limit):
            fed = share
        else:
            free = share
    return free


def liquid_at(metal: Metal, pool: int, region: IntArray, share: float) -> FloatArray:
    """Return the liquid of a pool after a share of the step [m³], (owned nodes,); collective.

    What froze between there and the end of the step is the pool's; where other pools have come from
    the same liquid, a part of it by what liquid they have at the end.

    Args:
        metal: of the body over the step.
        pool: its region.
        region: region of each node at the end of the step, −1: none, ghosts included, (nodes,).
        share: of the step.
    """
    own = region[: len(metal.volumes)]
    inside = own == pool
    if share == 1.0:
        return np.where(inside, metal.liquid(share), 0.0)
    comm = metal.regions.comm
    _, then = metal.regions.find(metal.fraction(share) < metal.limit)
    there = comm.allreduce(int(then[region == pool].max(initial=-1)), op=MPI.MAX)
    joined = (then[: len(own)] == there) & (there >= 0)
    left = np.where(joined & (own >= 0), metal.liquid(1.0), 0.0)
    mine, of_all = comm.allreduce(np.array([left[inside].sum(), left.sum()]), op=MPI.SUM)
    part = mine / of_all if of_all > 0 else 0.0
    weight = np.where(inside, 1.0, np.where(joined & (own < 0), part, 0.0))
    return weight * metal.liquid(share)
