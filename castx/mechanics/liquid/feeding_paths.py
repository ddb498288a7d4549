"""Liquid that is cut off: which cells of a body no liquid joins to a free surface."""

from __future__ import annotations

from collections.abc import Collection

from mpi4py import MPI

import numpy as np
from dolfinx import la
from dolfinx import mesh as dmesh
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from castx.arrays import BoolArray, IntArray, LongArray
from castx.domain.mesh import BodyMesh


class FeedingPaths:
    """Finds the liquid cells of a body that are not connected to a free surface by liquid.

    Args:
        body: mesh of the body.
        model: geometric model; the axis of an axisymmetric body is no surface.
        closed: names of the surfaces through which no liquid can follow.
    """

    def __init__(self, body: BodyMesh, model: str, closed: Collection[str]) -> None:
        self._comm = body.mesh.comm
        self._cell_nodes: IntArray = body.nodes.dofmap.list
        self._nodes = len(body.parent_vertices)
        index_map = body.nodes.dofmap.index_map
        self._shared = _shared_nodes(body)
        self._global: LongArray = index_map.local_to_global(np.arange(self._nodes, dtype=np.int32))
        self._at_free_surface = np.zeros(len(self._cell_nodes), dtype=bool)
        self._at_free_surface[_free_cells(body, model, closed)] = True

    def pockets(self, liquid: BoolArray) -> IntArray:
        """Return the number of the pocket of each cell, −1: none, shape (cells,); collective.

        A pocket is a set of liquid cells joined by their corners and by none of them to a free
        surface; all ranks have the same numbers.

        Args:
            liquid: the liquid cells of this rank, ghosts included, shape (cells,).
        """
        pocket = np.full(len(liquid), -1)
        count = 0
        if liquid.any():
            count, labels = self._regions(self._cell_nodes[liquid])
            pocket[liquid] = labels
        fed = np.zeros(count, dtype=bool)
        fed[pocket[liquid & self._at_free_surface]] = True
        total, common = self._joined(count, pocket)
        fed_everywhere = np.zeros(total, dtype=np.int32)
        fed_everywhere[common[fed]] = 1
        self._comm.Allreduce(MPI.IN_PLACE, fed_everywhere, op=MPI.MAX)
        number = np.where(fed_everywhere > 0, -1, np.cumsum(fed_everywhere == 0) - 1)
        found = np.full(len(liquid), -1, dtype=np.int32)
        found[liquid] = number[common[pocket[liquid]]]
        return found

    def trapped(self, liquid: BoolArray) -> BoolArray:
        """Return which of the liquid cells are cut off from all free surfaces; collective."""
        return self.pockets(liquid) >= 0

    def _joined(self, count: int, region: IntArray) -> tuple[int, IntArray]:
        """Return the number of regions of all ranks, and that of each region of this rank.

        Those that share a node between ranks are one.
        """
        first = self._comm.exscan(count, op=MPI.SUM) or 0
        total = self._comm.allreduce(count, op=MPI.SUM)
        inside = region >= 0
        corners = self._cell_nodes[inside].ravel()
        regions = np.repeat(first + region[inside], self._cell_nodes.shape[1])
        shared = self._shared[corners]
        links = np.column_stack([regions[shared], self._global[corners[shared]]])
        every = np.concatenate(self._comm.allgather(np.unique(links, axis=0)))
        nodes, places = np.unique(every[:, 1], return_inverse=True)
        size = total + len(nodes)
        ones = np.ones(len(every), dtype=np.int8)
        joins = coo_matrix((ones, (every[:, 0], total + places.ravel())), shape=(size, size))
        labels = connected_components(joins, directed=False)[1][:total]
        names, inverse = np.unique(labels, return_inverse=True)
        return len(names), inverse.ravel()[first : first + count].astype(np.int32)

    def _regions(self, cells: IntArray) -> tuple[int, IntArray]:
        """Return the number of connected regions of cells on this rank, and that of each cell."""
        number, corners = cells.shape
        rows = np.repeat(np.arange(number), corners)
        ones = np.ones(rows.size, dtype=np.int8)
        total = number + self._nodes
        joins = coo_matrix((ones, (rows, number + cells.ravel())), shape=(total, total))
        labels = connected_components(joins, directed=False)[1][:number]
        names, inverse = np.unique(labels, return_inverse=True)
        return len(names), inverse.ravel().astype(np.int32)


def _shared_nodes(body: BodyMesh) -> BoolArray:
    """Return which local nodes another rank has too, shape (nodes,); collective."""
    index_map = body.nodes.dofmap.index_map
    flags = la.vector(index_map, 1, dtype=np.int8)
    flags.array[:] = 0
    flags.array[index_map.size_local :] = 1
    flags.scatter_reverse(la.InsertMode.add)
    flags.array[:] = flags.array != 0
    flags.scatter_forward()
    return flags.array.astype(bool)


def _free_cells(body: BodyMesh, model: str, closed: Collection[str]) -> IntArray:
    """Return the owned cells with a facet on a free surface."""
    topology, dimension = body.mesh.topology, body.mesh.topology.dim
    outer = dmesh.exterior_facet_indices(topology)
    shut = [body.facet_tags.find(body.surfaces[name]) for name in closed]
    free = np.setdiff1d(outer, np.concatenate([np.zeros(0, dtype=np.int32), *shut]))
    if model == "axisymmetric":
        largest = np.abs(body.mesh.geometry.x[:, 0]).max(initial=0.0)
        on_axis = dmesh.locate_entities(
            body.mesh, dimension - 1, lambda x: np.abs(x[0]) < 1e-9 * largest
        )
        free = np.setdiff1d(free, on_axis)
    cells = topology.connectivity(dimension - 1, dimension)
    first = cells.offsets[free]
    return np.asarray(cells.array[first], dtype=np.int32)
