"""Pores of a mush as a complementarity of nodes: where they open, and where melt fills them.

At nodes that are not solid at the start of a step, or at its end, with R the volume that nothing
fills,

    p ≤ Δp_c,   R = φ V ≥ 0,   (Δp_c − p) R = 0,

so that either R = 0 or p = Δp_c. A primal–dual active set (M. Hintermüller, K. Ito and K. Kunisch,
SIAM Journal on Optimization 13 (2002)) changes between Newton iterations: a node opens where p
exceeds Δp_c, and closes where R is negative. Melt that no feeder reaches has no pressure in rigid
walls until a pore opens: one of its highest nodes begins open where it freezes, the one with most
melt, and where it rests its highest nodes keep the pressure of the last step as long as R = 0. All
highest nodes open would hold a pool without weight at the cavity pressure throughout.

There is no gas in a pore. Hydrogen by Sieverts' law would make Δp_c a function of φ and of what the
melt around has left: here, where a node opens and closes by it, and in `castx.mechanics.darcy`,
where the rows of open nodes hold p at it.
"""

from __future__ import annotations

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray, LongArray
from castx.domain.measures import nodal_sum
from castx.domain.mesh import BodyMesh
from castx.mechanics.liquid.regions import CellRegions
from castx.stateful import Arrays, Saved

NEGATIVE = 1e-12
"""Pore fraction below which a pore is closed: rounding of volumes."""
LACKING = 1e-9
"""Share of its volume that a node of melt that rests has to lack before it opens, or to have too
much of before its pressure rises: rounding of the flow, which is fast in melt without solid. What
lacks less is not lost: the next step finds it."""
LEVEL = 1e-9
"""Difference of heads relative to the largest one by which two nodes are equally high."""
EXCEEDING = 1e-9
"""Part of Δp_c by which p may exceed it; of the weight of the melt without it."""
SAME_MELT = 1e-6
"""Difference of liquid fractions by which two nodes have equally much melt."""
MOST_CHANGES = 6
"""Changes of one node in a solution after which it stays open."""


class PoreSet:
    """Nodes of a body at which pores are open.

    Args:
        body: mesh of the body.
        potential: x·b of the body force b at the local nodes [Pa], shape (nodes,).
        cavitation: Δp_c [Pa].

    Attributes:
        open: owned nodes with pores in the trial step, shape (owned,).
        resting: owned nodes that keep their pressure in it, likewise.
        changed: whether the last call of `change` has changed any on this rank.
    """

    def __init__(self, body: BodyMesh, potential: FloatArray, cavitation: float) -> None:
        self._body, self._potential, self._cavitation = body, potential, cavitation
        self._regions = CellRegions(body)
        self._owned = int(body.nodes.dofmap.index_map.size_local)
        comm = self._regions.comm
        largest = comm.allreduce(float(np.abs(potential).max(initial=0.0)), op=MPI.MAX)
        self._level, self._slack = LEVEL * largest, EXCEEDING * max(cavitation, largest)
        self.open: BoolArray = np.zeros(self._owned, dtype=bool)
        self._committed: BoolArray = self.open
        self._may: BoolArray = self.open
        self.resting: BoolArray = self.open
        self._changes: IntArray = np.zeros(self._owned, dtype=np.int32)
        self.changed = False

    def begin(
        self,
        liquid: FloatArray,
        freezes: BoolArray,
        melts: BoolArray,
        conducts: BoolArray,
        fed: BoolArray,
        empty: BoolArray,
    ) -> None:
        """Begin a trial step; collective.

        Args:
            liquid: liquid fraction of the local nodes at its start, shape (nodes,).
            freezes: whether their solid fraction rises in the step, shape (nodes,).
            melts: whether they are solid at its start and no longer at its end, likewise.
            conducts: whether melt flows in the cells, shape (cells,).
            fed: local nodes that feeders keep at their pressure, shape (nodes,).
            empty: whether a node of the cells has lost its melt, shape (cells,).
        """
        own = slice(self._owned)
        self._may = ((liquid > 0.0) | melts)[own] & ~fed[own]
        self.open = self._committed & self._may & ~melts[own]
        self.resting = self._may & False
        self.open |= self._left(conducts, empty) & self._may
        first, resting = self._tops(liquid, freezes, conducts, fed)
        self.open, self.resting = self.open | (first & self._may), resting & self._may
        self._changes[:] = 0
        self.changed = False

    def _left(self, conducts: BoolArray, empty: BoolArray) -> BoolArray:
        """Return the owned nodes beside cells without melt that no cell connects to others."""
        corners = self._regions.cell_nodes
        marks = np.zeros((2, len(self._potential)))
        marks[0, corners[empty]] = marks[1, corners[conducts]] = 1.0
        beside, joined = (nodal_sum(self._body, mark) > 0.0 for mark in marks)
        return np.asarray(beside & ~joined)[: self._owned]

    def _tops(
        self, liquid: FloatArray, freezes: BoolArray, conducts: BoolArray, fed: BoolArray
    ) -> tuple[BoolArray, BoolArray]:
        """Return owned nodes of pools without feeder or pore: the first to open, and the resting.

        The first of a pool that freezes is, of its highest nodes, the one with the most melt; of
        equal ones the first in the mesh file. Where a pool rests, all its highest nodes do.
        """
        comm = self._regions.comm
        count, region = self._regions.find(conducts, liquid > 0.0)
        of_node = np.full(len(liquid), -1, dtype=np.int64)
        of_node[self._regions.cell_nodes[conducts]] = region[conducts][:, None]
        inside = np.flatnonzero((of_node >= 0) & (liquid > 0.0))
        pool, held = of_node[inside], fed.copy()
        held[: self._owned] |= self.open
        reached, freezing = np.zeros((2, count), dtype=np.int32)
        reached[pool[held[inside]]] = 1
        freezing[pool[freezes[inside]]] = 1
        comm.Allreduce(MPI.IN_PLACE, reached, op=MPI.MAX)
        comm.Allreduce(MPI.IN_PLACE, freezing, op=MPI.MAX)
        lowest = self._lowest_of_pools(self._potential[inside], pool, count)
        at_top = (self._potential[inside] <= lowest[pool] + self._level) & (reached[pool] == 0)
        freezes_there = freezing[pool] > 0
        tops, of_top = inside[at_top & freezes_there], pool[at_top & freezes_there]
        first = self._first_of_pools(tops, of_top, count, liquid)
        return self._on_owners(first), self._on_owners(inside[at_top & ~freezes_there])

    def _first_of_pools(
        self, nodes: LongArray, pool: LongArray, count: int, liquid: FloatArray
    ) -> LongArray:
        """Return the local node with the most melt of each pool, of equal ones the first."""
        most = -self._lowest_of_pools(-liquid[nodes], pool, count)
        melting = liquid[nodes] >= most[pool] - SAME_MELT
        nodes, pool = nodes[melting], pool[melting]
        numbers = self._body.original_nodes[nodes].astype(np.float64)
        first = self._lowest_of_pools(numbers, pool, count)
        return np.asarray(nodes[numbers == first[pool]])

    def _lowest_of_pools(self, values: FloatArray, pool: LongArray, count: int) -> FloatArray:
        """Return the lowest value of each pool over all ranks, shape (count,); collective."""
        lowest = np.full(count, np.inf)
        np.minimum.at(lowest, pool, values)
        self._regions.comm.Allreduce(MPI.IN_PLACE, lowest, op=MPI.MIN)
        return lowest

    def _on_owners(self, nodes: LongArray) -> BoolArray:
        """Return a mask of the owned nodes that any rank has found, shape (owned,); collective."""
        found = np.zeros(len(self._potential))
        found[nodes] = 1.0
        return np.asarray(nodal_sum(self._body, found)[: self._owned] > 0.0)

    def change(self, missing: FloatArray, volumes: FloatArray, stress: FloatArray) -> bool:
        """Open and close pores at an iterate; return whether any has changed on this rank.

        Args:
            missing: R of the owned nodes [m³], shape (owned,).
            volumes: V of the owned nodes [m³], likewise.
            stress: p of the owned nodes [Pa], likewise.
        """
        slack, moved = NEGATIVE * volumes, LACKING * volumes
        closes = self.open & (missing < -slack) & (self._changes < MOST_CHANGES)
        exceeds = (stress > self._cavitation + self._slack) & ~self.resting
        opens = self._may & ~self.open & (exceeds | (self.resting & (missing > moved)))
        leaves = self.resting & (opens | (missing < -moved))
        changed = closes | opens | leaves
        self.open, self.resting = (self.open & ~closes) | opens, self.resting & ~leaves
        self._changes += changed
        self.changed = bool(changed.any())
        return self.changed

    @property
    def open_at_start(self) -> BoolArray:
        """Owned nodes with pores at the start of the step, shape (owned,)."""
        return self._committed

    def commit(self) -> None:
        """Accept the trial state as the start of the next step."""
        self._committed = self.open.copy()

    def rewind(self) -> None:
        """Return to the start of the step."""
        self.open, self.resting = self._committed.copy(), self.resting & False

    def saved(self) -> dict[str, Saved]:
        """Return the open nodes."""
        return {"open": Saved(self._committed, self._body.node_numbering)}

    def restore(self, arrays: Arrays) -> None:
        """Take them back."""
        self._committed = arrays["open"][: self._owned].astype(bool)
        self.rewind()
