"""Rows in which the displacement of each node of a body is expressed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.solvers.layout import Layout


def owned_nodes(layout: Layout, b: int) -> int:
    """Return the number of nodes of a body that this rank owns."""
    part = layout.local_slice(b)
    return int(part.stop - part.start) // layout.block_sizes[b]


@dataclass
class NodeRows:
    """Rows for the owned nodes of one body, in slots 0, 1, … of each node.

    Attributes:
        rows: shape (nodes, dimension, dimension); slots from `count` on are empty.
        count: number of rows of each node, shape (nodes,).
    """

    rows: FloatArray
    count: IntArray

    @classmethod
    def none(cls, nodes: int, dimension: int) -> NodeRows:
        """Return nodes without rows."""
        return cls(np.zeros((nodes, dimension, dimension)), np.zeros(nodes, dtype=np.int32))

    def copy(self) -> NodeRows:
        """Return an independent copy of the rows."""
        return NodeRows(self.rows.copy(), self.count.copy())

    def try_add(self, nodes: IntArray, directions: FloatArray, smallest: float) -> IntArray:
        """Add a row at each node where it is independent; return slots, -1 where it is not."""
        free = self.can_add(nodes, directions, smallest)
        chosen = nodes[free]
        slots = np.full(len(nodes), -1, dtype=np.int32)
        slots[free] = self.count[chosen]
        self.rows[chosen, self.count[chosen]] = directions[free]
        self.count[chosen] += 1
        return slots

    def can_add(
        self, nodes: IntArray, directions: FloatArray, smallest: float
    ) -> BoolArray:
        """Return where a direction is independent of the rows: its rest exceeds `smallest`."""
        rest = directions.copy()
        orthonormal = self._orthonormal(nodes)
        for k in range(orthonormal.shape[1]):
            q = orthonormal[:, k]
            rest -= np.sum(rest * q, axis=1, keepdims=True) * q
        free = np.linalg.norm(rest, axis=1) > smallest
        return np.asarray(free & (self.count[nodes] < self.rows.shape[1]))

    def complement(self, nodes: IntArray) -> FloatArray:
        """Return orthonormal directions normal to the rows, then zeros, (n, dimension, dimension).

        Where there are no rows they are the axes.
        """
        dimension = self.rows.shape[1]
        found = np.zeros((len(nodes), dimension, dimension))
        found[self.count[nodes] == 0] = np.eye(dimension)
        for m in range(1, dimension):
            here = self.count[nodes] == m
            if here.any():
                rows = self.rows[nodes[here], :m].transpose(0, 2, 1)
                q = np.linalg.qr(rows, mode="complete")[0]
                found[here, : dimension - m] = q[:, :, m:].transpose(0, 2, 1)
        return found

    def _orthonormal(self, nodes: IntArray) -> FloatArray:
        basis = np.zeros((len(nodes), *self.rows.shape[1:]))
        for m in range(1, self.rows.shape[1] + 1):
            here = self.count[nodes] == m
            if here.any():
                q = np.linalg.qr(self.rows[nodes[here], :m].transpose(0, 2, 1))[0]
                basis[here, :m] = q.transpose(0, 2, 1)
        return basis

    def complete(self) -> IntArray:
        """Complete the rows of every node to a basis; return the nodes that have any."""
        dimension = self.rows.shape[1]
        special = np.flatnonzero(self.count).astype(np.int32)
        for m in range(1, dimension):
            nodes = special[self.count[special] == m]
            self.rows[nodes, m:] = self.complement(nodes)[:, : dimension - m]
        return special
