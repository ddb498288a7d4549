"""Regions of chosen nodes joined by edges, with the same numbers on any ranks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mpi4py import MPI

import basix
import numpy as np

from castx.arrays import BoolArray, IntArray
from castx.domain.measures import nodal_sum
from castx.mechanics.liquid.regions import Regions

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh


class NodeRegions:
    """Finds the regions of nodes that are joined by edges of cells with both ends among them.

    Args:
        body: mesh of the body.

    Attributes:
        comm: ranks of the body.
    """

    def __init__(self, body: BodyMesh) -> None:
        cells: IntArray = body.nodes.dofmap.list
        ends = np.array(basix.topology(basix.CellType[body.kind.name])[1])
        edges = np.unique(np.sort(cells[:, ends].reshape(-1, 2), axis=1), axis=0)
        nodes = np.arange(len(body.parent_vertices), dtype=np.int32)
        # A node that no edge joins to another one is a region of its own.
        self._pairs = np.concatenate([np.column_stack([nodes, nodes]), edges.astype(np.int32)])
        self._regions = Regions(body, self._pairs)
        self._original, self._body = body.original_nodes, body
        self.comm: MPI.Intracomm = self._regions.comm

    def find(self, chosen: BoolArray) -> tuple[int, IntArray]:
        """Return the number of regions, and the region of each node or −1, (nodes,); collective.

        They are in the order of their lowest nodes in the mesh before it was distributed, so that
        their numbers do not depend on the ranks.

        Args:
            chosen: nodes of this rank, ghosts included, (nodes,).
        """
        count, found = self._regions.find(chosen[self._pairs].all(axis=1))
        region = found[: len(chosen)]
        lowest = np.full(count, np.iinfo(np.int64).max)
        np.minimum.at(lowest, region[chosen], self._original[chosen])
        self.comm.Allreduce(MPI.IN_PLACE, lowest, op=MPI.MIN)
        place = np.empty(count, dtype=np.int32)
        place[np.argsort(lowest)] = np.arange(count, dtype=np.int32)
        return count, np.where(chosen, place[region], -1) if count else region

    def join(self, some: BoolArray, others: BoolArray, chosen: BoolArray) -> bool:
        """Return whether a connected region of chosen nodes has nodes of both sets; collective.

        Arguments are of the nodes of this rank, ghosts included, (nodes,).
        """
        count, region = self.find(chosen)
        touching = np.zeros(count + 1, dtype=np.int32)  # region -1 is the last one
        np.maximum.at(touching, region, (others & chosen).astype(np.int32))
        self.comm.Allreduce(MPI.IN_PLACE, touching, op=MPI.MAX)
        here = bool(touching[region[some]].any())
        return bool(self.comm.allreduce(here, MPI.LOR))

    def neighbours_of(self, marked: BoolArray) -> BoolArray:
        """Return the neighbours of marked nodes along edges; collective.

        Args:
            marked: by kinds of marks, ghosts included, (nodes, kinds).

        Returns:
            Of the same shape, ghosts included.
        """
        found = np.zeros(marked.shape)
        for one, other in (self._pairs.T, self._pairs.T[::-1]):
            np.maximum.at(found, one, np.where(one != other, 1.0, 0.0)[:, None] * marked[other])
        for kind in range(found.shape[1]):
            found[:, kind] = nodal_sum(self._body, found[:, kind])
        return np.asarray(found > 0.0)
