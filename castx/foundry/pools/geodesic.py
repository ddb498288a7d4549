"""Shortest paths inside a body: along edges of its cells, then straight through its cells.

Distances along edges are too long by the zigzag of the mesh. They are refined by the eikonal
equation |∇d| = 1 with d linear on the faces of cells: with P the vectors from a corner to others
and Q = (P Pᵀ)⁻¹ the distance t of the corner solves (d - t)ᵀ Q (d - t) = 1, and counts if the path
comes through between these others, -Q (d - t) ≥ 0 (R. Kimmel and J. A. Sethian, Computing geodesic
paths on manifolds, Proc. Natl. Acad. Sci. 95 (1998) 8431-8435).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Self

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from castx.arrays import BoolArray, FloatArray, LongArray

SETTLED = 1e-10
"""Change of a distance, beside the extent of the body, that counts as none."""
FLAT = 1e-12
"""Square of the volume between vectors, beside that of a cube of their lengths, of flat ones."""
BETWEEN = -1e-9
"""Weight of a corner, beside the largest one, from which a path still passes between."""


@dataclass(frozen=True, eq=False)
class Ways:
    """Ways to corners of cells from between some others of the same cell.

    Attributes:
        targets: (ways,).
        sources: (ways, corners).
        inverses: Q, (ways, corners, corners) [1/m²].
    """

    targets: LongArray
    sources: LongArray
    inverses: FloatArray

    @classmethod
    def of(cls, points: FloatArray, cells: LongArray, others: int) -> Self:
        """Return the ways from between a number of other corners, without flat ones."""
        corners = range(cells.shape[1])
        chosen = [
            (target, sources)
            for target in corners
            for sources in combinations([c for c in corners if c != target], others)
        ]
        targets = np.concatenate([cells[:, target] for target, _ in chosen])
        sources = np.concatenate([cells[:, list(of)] for _, of in chosen])
        vectors = points[sources] - points[targets][:, None]
        squares = np.einsum("wik,wjk->wij", vectors, vectors)
        size = np.prod(np.einsum("wii->wi", squares), axis=1)
        solid = np.linalg.det(squares) > FLAT * size
        return cls(targets[solid], sources[solid], np.linalg.inv(squares[solid]))

    def times(self, distances: FloatArray, changed: BoolArray) -> tuple[LongArray, FloatArray]:
        """Return targets of ways with a changed source, and the distances by these ways."""
        known = changed[self.sources].any(axis=1) & np.isfinite(distances[self.sources]).all(axis=1)
        inverse, values = self.inverses[known], distances[self.sources[known]]
        sums = inverse.sum(axis=2)
        square, middle = sums.sum(axis=1), (sums * values).sum(axis=1)
        rest = np.einsum("wi,wij,wj->w", values, inverse, values) - 1.0
        root = middle**2 - square * rest
        found = (middle + np.sqrt(np.maximum(root, 0.0))) / square
        weights = np.einsum("wij,wj->wi", inverse, found[:, None] - values)
        between = weights.min(axis=1) >= BETWEEN * np.abs(weights).max(axis=1)
        kept = (root >= 0.0) & between
        return self.targets[known][kept], found[kept]


def shortest_paths(points: FloatArray, cells: LongArray, sources: BoolArray) -> FloatArray:
    """Return the lengths of the shortest paths inside cells to some nodes, (nodes,) [m].

    Infinite where there is none.

    Args:
        points: (nodes, dimension) [m].
        cells: convex ones by their nodes, (cells, corners).
        sources: whether a path may end there, (nodes,).
    """
    found = np.full(len(points), np.inf)
    if not sources.any():
        return found
    pairs = np.array(list(combinations(range(cells.shape[1]), 2)))
    edges = np.unique(np.sort(cells[:, pairs].reshape(-1, 2), axis=1), axis=0)
    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    graph = coo_matrix((lengths, edges.T), shape=(len(points), len(points))).tocsr()
    ends = np.flatnonzero(sources)
    found = dijkstra(graph, directed=False, indices=ends, min_only=True)
    ways = [Ways.of(points, cells, others) for others in range(1, points.shape[1] + 1)]
    tolerance = SETTLED * float(np.ptp(points, axis=0).max())
    changed = np.isfinite(found)
    while changed.any():
        before = found.copy()
        for way in ways:
            np.minimum.at(found, *way.times(before, changed))
        changed = found < before - tolerance
    return np.asarray(found)
