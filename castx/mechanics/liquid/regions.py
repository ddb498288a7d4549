"""Connected regions of chosen cells, or other groups of nodes, the same on any number of ranks."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
from dolfinx import la
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from castx.arrays import BoolArray, IntArray, LongArray
from castx.domain.mesh import BodyMesh


class Regions:
    """Finds the regions of groups of nodes that are joined by common nodes.

    Args:
        body: mesh of the body.
        groups: local nodes of each group, shape (groups, nodes of a group); a group may stand on
            several ranks, and stands on one at least.

    Attributes:
        comm: ranks that share the body.
    """

    def __init__(self, body: BodyMesh, groups: IntArray) -> None:
        index_map = body.nodes.dofmap.index_map
        nodes = np.arange(len(body.parent_vertices), dtype=np.int32)
        self.comm = body.mesh.comm
        self._groups = groups
        self._global: LongArray = index_map.local_to_global(nodes)
        self._shared = _shared_nodes(body)

    def find(
        self, chosen: BoolArray, joining: BoolArray | None = None
    ) -> tuple[int, IntArray]:
        """Return the number of regions, and the region of each group or −1, (groups,); collective.

        All ranks number the regions alike.

        Args:
            chosen: groups of this rank, those of ghosts included, shape (groups,).
            joining: local nodes by which groups are joined, shape (nodes,), at least one of each
                chosen group; None: all of them.
        """
        nodes = self._groups[chosen]
        joins = np.ones(nodes.shape, dtype=bool) if joining is None else joining[nodes]
        groups = np.repeat(np.arange(len(nodes)), self._groups.shape[1])[joins.ravel()]
        count, of_group = _joined(groups, nodes[joins], len(nodes), len(self._global))
        total, of_region = self._across_ranks(count, of_group, nodes, joins)
        found = np.full(len(chosen), -1, dtype=np.int32)
        found[chosen] = of_region[of_group]
        return total, found

    def _across_ranks(
        self, count: int, region: IntArray, group_nodes: IntArray, joins: BoolArray
    ) -> tuple[int, IntArray]:
        """Return the number of regions on all ranks, and the global number of each local region.

        Those that have a joining node in common are one.
        """
        if self.comm.size == 1:
            return count, np.arange(count, dtype=np.int32)
        first = self.comm.exscan(count, op=MPI.SUM) or 0
        total = self.comm.allreduce(count, op=MPI.SUM)
        shared = self._shared[group_nodes] & joins
        regions = np.broadcast_to(first + region[:, None], group_nodes.shape)[shared]
        links = np.column_stack([regions, self._global[group_nodes[shared]]])
        every = np.concatenate(self.comm.allgather(np.unique(links, axis=0)))
        nodes, columns = np.unique(every[:, 1], return_inverse=True)
        number, of_region = _joined(every[:, 0], columns.ravel(), total, len(nodes))
        return number, of_region[first : first + count]


class CellRegions(Regions):
    """Finds the regions of cells that are joined by common nodes.

    Args:
        body: mesh of the body.

    Attributes:
        cell_nodes: nodes of each cell, shape (cells, corners).
    """

    def __init__(self, body: BodyMesh) -> None:
        self.cell_nodes: IntArray = body.nodes.dofmap.list
        super().__init__(body, self.cell_nodes)


def _joined(
    rows: IntArray | LongArray, columns: IntArray | LongArray, row_count: int, column_count: int
) -> tuple[int, IntArray]:
    """Return the number of groups of rows that common columns join, and the group of each row."""
    size = row_count + column_count
    ones = np.ones(len(rows), dtype=np.int8)
    links = coo_matrix((ones, (rows, row_count + columns)), shape=(size, size))
    labels = connected_components(links, directed=False)[1][:row_count]
    names, group = np.unique(labels, return_inverse=True)
    return len(names), group.ravel().astype(np.int32)


def _shared_nodes(body: BodyMesh) -> BoolArray:
    """Return a mask of the local nodes that another rank has too, shape (nodes,); collective."""
    index_map = body.nodes.dofmap.index_map
    copies = la.vector(index_map, 1, dtype=np.int32)
    copies.array[:] = 0
    copies.array[index_map.size_local :] = 1
    copies.scatter_reverse(la.InsertMode.add)
    copies.scatter_forward()
    return np.asarray(copies.array > 0)
