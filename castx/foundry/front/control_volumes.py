"""The control volume of a node: of each cell around it the part that is nearest to the node.

The heat balance of a node says what its control volume stores, so that the enthalpy of a node is
the mean over that volume. On simplices it is the part in which the node has the largest
barycentric coordinate, elsewhere the corner half of the cell in each direction: its share of the
lumped storage.
"""

from __future__ import annotations

from itertools import permutations, product
from typing import TYPE_CHECKING

import basix
import numpy as np
from dolfinx import la

from castx.arrays import BoolArray, FloatArray, LongArray

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh


class ControlVolumes:
    """Points in the control volumes of the nodes of a body, and the volumes they stand for.

    Attributes:
        nodes: number of the nodes on this rank, ghosts included.
        cell_nodes: local nodes of the owned cells, (cells, corners).
        shapes: shape functions of all corners at the points that belong to one of them, (corner to
            which they belong, points, corners).
        volumes: (cells, corner to which they belong, points) [m³, in the model's sense].

    Args:
        body: the body.
        axisymmetric: whether the first coordinate is a radius.
    """

    def __init__(self, body: BodyMesh, axisymmetric: bool = False) -> None:
        self._body = body
        space = body.nodes
        element = space.element.basix_element
        cells = space.mesh.topology.index_map(space.mesh.topology.dim).size_local
        self.cell_nodes: LongArray = space.dofmap.list[:cells].astype(np.int64)
        points, weights = corner_points(element.cell_type)
        corners, count, dimension = points.shape
        table = element.tabulate(1, points.reshape(-1, dimension))[..., 0]
        self.shapes = table[0].reshape(corners, count, corners)
        slopes = table[1:].reshape(dimension, corners, count, corners)
        positions = body.points[self.cell_nodes]
        jacobians = np.einsum("cbi,kaqb->caqik", positions, slopes)
        self.volumes = np.abs(np.linalg.det(jacobians)) * weights
        if axisymmetric:
            radii = np.einsum("cb,aqb->caq", positions[..., 0], self.shapes)
            self.volumes *= radii
        self.nodes = len(body.points)
        everywhere = self.around(np.ones(self.nodes, dtype=bool))
        own_volumes = self.volumes[everywhere].sum(axis=1)
        self._total = self.added([self.at_nodes(everywhere, own_volumes)])[0]

    def around(self, nodes: BoolArray) -> tuple[LongArray, LongArray]:
        """Return cell and corner of all parts of the control volumes of marked nodes (nodes,)."""
        cells, corners = np.nonzero(nodes[self.cell_nodes])
        return cells, corners

    def added(self, sums: list[FloatArray]) -> FloatArray:
        """Return local sums, each (nodes,), over all ranks: (sums, nodes); collective."""
        vector = la.vector(self._body.nodes.dofmap.index_map, len(sums))
        vector.array[:] = np.column_stack(sums).ravel()
        vector.scatter_reverse(la.InsertMode.add)
        vector.scatter_forward()
        return np.ascontiguousarray(vector.array.reshape(-1, len(sums)).T)

    def at_nodes(self, parts: tuple[LongArray, LongArray], values: FloatArray) -> FloatArray:
        """Return sums of values of parts (parts,) at the nodes on this rank, (nodes,)."""
        size = len(self._body.parent_vertices)
        return np.bincount(self.cell_nodes[parts], values, size).astype(np.float64)

    def shares(self, parts: tuple[LongArray, LongArray], values: FloatArray) -> FloatArray:
        """Return the part of this rank in the means over the control volumes, (nodes,).

        Args:
            parts: cell and corner of each part.
            values: at their points, (parts, points).
        """
        sums = (self.volumes[parts] * values).sum(axis=1)
        return np.asarray(self.at_nodes(parts, sums) / self._total)

    def means(self, parts: tuple[LongArray, LongArray], values: FloatArray) -> FloatArray:
        """Return means over control volumes, (nodes,), arguments as for `shares`; collective."""
        return np.asarray(self.added([self.shares(parts, values)])[0])


def corner_points(kind: basix.CellType) -> tuple[FloatArray, FloatArray]:
    """Return points in the part of a cell that belongs to each corner, and their volumes.

    Args:
        kind: of the cell.

    Returns:
        (corners, points, dimension) in the reference cell, (points,).
    """
    vertices = np.asarray(basix.geometry(kind))
    corners, dimension = vertices.shape
    if corners == dimension + 1:
        shares = simplex_shares(dimension)
        weights = np.array([np.insert(shares, a, largest, axis=1) for a, largest in
                            enumerate([_largest(dimension)] * corners)])  # fmt: skip
        points = weights @ vertices
    else:
        offsets = np.array(list(product((0.125, 0.375), repeat=dimension)))
        points = np.abs(vertices[:, None, :] - offsets)
    count = points.shape[1]
    return points, np.full(count, basix.cell.volume(kind) / corners / count)


def _largest(dimension: int) -> float:
    return float(np.mean(1.0 / np.arange(1, dimension + 2)))


def simplex_shares(dimension: int) -> FloatArray:
    """Return barycentric coordinates of the other corners at the points of one corner's part.

    The part falls into simplices, one for each order in which the other coordinates may lie; their
    centroids have the coordinates (1/(d + 1)) Σ_(m=k)^(d+1) 1/m, k = 1 that of the corner itself.
    """
    inverse = 1.0 / np.arange(1, dimension + 2)
    ranked = np.cumsum(inverse[::-1])[::-1] / (dimension + 1)
    return np.array(list(permutations(ranked[1:])))
