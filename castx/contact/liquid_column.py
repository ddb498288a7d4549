"""Pressure of a liquid at rest: that of its column below the highest point of the same liquid."""

from __future__ import annotations

import numpy as np
from dolfinx import la
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.domain.mesh import BodyMesh


def column_pressure(body: BodyMesh, liquid: BoolArray, head: FloatArray) -> FloatArray:
    """Return p = x·b - min x·b over the liquid that a node is connected to; collective.

    Cells with a common node are connected.

    Args:
        body: the mesh.
        liquid: liquid cells of this rank, ghosts included, shape (cells,).
        head: x·b at the local nodes with the body force b [Pa], shape (nodes,).

    Returns:
        At the local nodes [Pa], shape (nodes,); zero where no liquid cell is on this rank.
    """
    highest = _least_in_region(body, liquid, head)
    return np.where(np.isfinite(highest), head - highest, 0.0)


def _least_in_region(body: BodyMesh, cells: BoolArray, values: FloatArray) -> FloatArray:
    """Return the least value of the region of chosen cells of each node, infinite without one."""
    nodes, index_map = len(values), body.nodes.dofmap.index_map
    corners: IntArray = body.nodes.dofmap.list[cells]
    rows = np.repeat(np.arange(len(corners)), corners.shape[1])
    count, labels = _components(rows, corners.ravel(), len(corners), nodes)
    region = np.full(nodes, -1)
    region[corners.ravel()] = labels[rows]
    inside = region >= 0
    least = np.full(count, np.inf)
    np.minimum.at(least, region[inside], values[inside])
    shared = np.flatnonzero(inside & _shared(body))
    numbers = index_map.local_to_global(shared.astype(np.int32))
    parts = body.mesh.comm.allgather((numbers, region[shared], least))
    starts = np.cumsum([0, *(len(part[2]) for part in parts)])
    ends = [own + start for (_, own, _), start in zip(parts, starts[:-1], strict=True)]
    known, columns = np.unique(np.concatenate([p[0] for p in parts]), return_inverse=True)
    joined, of = _components(np.concatenate(ends), columns, int(starts[-1]), len(known))
    total = np.full(joined, np.inf)
    np.minimum.at(total, of, np.concatenate([p[2] for p in parts]))
    first = starts[body.mesh.comm.rank]
    mine = total[of[first : first + count]]
    found = np.full(nodes, np.inf)
    found[inside] = mine[region[inside]]
    return found


def _components(
    rows: IntArray, columns: IntArray, row_count: int, column_count: int
) -> tuple[int, IntArray]:
    """Return the number of groups of rows that columns join, and the group of each row."""
    total = row_count + column_count
    ones = np.ones(len(rows), dtype=np.int8)
    joins = coo_matrix((ones, (rows, row_count + columns)), shape=(total, total))
    labels = connected_components(joins, directed=False)[1][:row_count]
    names, group = np.unique(labels, return_inverse=True)
    return len(names), group.astype(np.int32)


def _shared(body: BodyMesh) -> BoolArray:
    """Return which local nodes other ranks know too, shape (nodes,); collective."""
    index_map = body.nodes.dofmap.index_map
    copies = la.vector(index_map, 1, dtype=np.int32)
    copies.array[:] = 0
    copies.array[index_map.size_local :] = 1
    copies.scatter_reverse(la.InsertMode.add)
    copies.scatter_forward()
    return np.asarray(copies.array > 0)
