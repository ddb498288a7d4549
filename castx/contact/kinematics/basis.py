"""Matrices between the displacements of all bodies and the unknowns of a constraint transform."""

from __future__ import annotations

from collections.abc import Sequence

from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray, IntArray, LongArray
from castx.contact.kinematics.node_rows import NodeRows
from castx.solvers.layout import Layout


class BasisMatrices:
    """R and P of v = R u and u = P v, filled node by node, then by motions relative to other nodes.

    Args:
        layout: numbering of the displacements (and pressures) of all bodies.
        dimension: number of displacement components.
        rows: rows of the nodes of each body; those of nodes that have any are completed to a basis.
    """

    def __init__(self, layout: Layout, dimension: int, rows: Sequence[NodeRows]) -> None:
        self._layout, self._dimension, self._rows = layout, dimension, list(rows)
        sizes = ((layout.size_local, layout.size_global),) * 2
        self._forward, self._frames, self._relative = (
            PETSc.Mat().createAIJ(sizes, nnz=12, comm=layout.comm) for _ in range(3)
        )
        for matrix in (self._forward, self._frames, self._relative):
            matrix.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
        ones = self._forward.createVecLeft()
        ones.set(1.0)
        self._forward.setDiagonal(ones)
        self._frames.setDiagonal(ones)
        ones.destroy()
        self._duals = [self._fill_frames(b) for b in range(len(self._rows))]

    def _first(self, b: int) -> int:
        return self._layout.first + self._layout.local_slice(b).start

    def _fill_frames(self, b: int) -> FloatArray:
        """Fill the frames of the nodes of a body; return their dual bases as columns."""
        rows, d, size = self._rows[b], self._dimension, self._layout.block_sizes[b]
        inverse = np.tile(np.eye(d), (len(rows.count), 1, 1))
        special = rows.complete()
        inverse[special] = np.linalg.inv(rows.rows[special])
        for i in special:
            dofs = (self._first(b) + i * size + np.arange(d)).astype(np.int32)
            self._forward.setValues(dofs, dofs, rows.rows[i])
            self._frames.setValues(dofs, dofs, inverse[i])
        return inverse

    def tie(self, b: int, nodes: IntArray, slots: IntArray) -> IntArray:
        """Take a row of nodes relative to the first one; return the local numbers that are zero.

        Args:
            b: number of the body.
            nodes: local numbers of owned nodes, shape (n,).
            slots: row of each node, shape (n,).
        """
        comm, d, size = self._layout.comm, self._dimension, self._layout.block_sizes[b]
        starts = (self._first(b) + nodes * size).astype(np.int32)
        columns = starts[:, None] + np.arange(d, dtype=np.int32)
        own = starts + slots
        firsts = comm.allgather(
            (own[0], columns[0], self._rows[b].rows[nodes[0], slots[0]]) if len(own) else None
        )
        found = next((entry for entry in firsts if entry is not None), None)
        if found is None:
            return np.zeros(0, dtype=np.int32)
        first, first_columns, row = found
        others = np.flatnonzero(own != first)
        for i in others:
            self._forward.setValues(own[i], first_columns, -row)
            self._frames.setValues(columns[i], first, self._duals[b][nodes[i]][:, slots[i]])
        return np.asarray(own[others] - self._layout.first, dtype=np.int32)

    def tie_component(self, b: int, k: int) -> IntArray:
        """Take a component of all nodes of a body relative to the first of them.

        Returns:
            The local numbers that are zero.
        """
        nodes = np.arange(len(self._rows[b].count))
        own = (self._first(b) + nodes * self._layout.block_sizes[b] + k).astype(np.int32)
        firsts = self._layout.comm.allgather(own[0] if len(own) else None)
        first = next(number for number in firsts if number is not None)
        others = own[own != first]
        for row in others:
            self._forward.setValue(row, first, -1.0)
            self._frames.setValue(row, first, 1.0)
        return np.asarray(others - self._layout.first, dtype=np.int32)

    def make_relative(
        self,
        b: int,
        nodes: IntArray,
        local: IntArray,
        directions: FloatArray,
        other: int,
        partners: tuple[LongArray, FloatArray],
    ) -> None:
        """Take rows of nodes of one body relative to points of another.

        Args:
            b: number of the body.
            nodes: local numbers of its owned nodes, shape (n,).
            local: local number of the row of each in v, shape (n,).
            directions: of the rows, shape (n, dimension).
            other: number of the other body.
            partners: global numbers of its nodes, of any owner, and their weights, (n, corners).
        """
        components = np.arange(self._dimension)
        nodes_there, weights = partners
        columns = np.stack(
            [self._layout.dofs(other, nodes_there, k) for k in range(self._dimension)], axis=2
        )
        starts = (self._first(b) + nodes * self._layout.block_sizes[b]).astype(np.int32)
        rows = (local + self._layout.first).astype(np.int32)
        slots = rows - starts
        for i, n in enumerate(directions):
            dual = self._duals[b][nodes[i]][:, slots[i]]
            targets = (starts[i] + components).astype(np.int32)
            for numbers, weight in zip(columns[i], weights[i], strict=True):
                self._forward.setValues(rows[i], numbers, -weight * n)
                # Several rows of one pair add up.
                self._relative.setValues(
                    targets, numbers, weight * np.outer(dual, n), PETSc.InsertMode.ADD_VALUES
                )

    def finish(self) -> tuple[PETSc.Mat, PETSc.Mat]:
        """Return R and P; the caller destroys them."""
        for matrix in (self._forward, self._frames, self._relative):
            matrix.assemble()
        to_displacements = _sum_of_powers(self._relative, self._frames)
        self._relative.destroy()
        return self._forward, to_displacements


def _sum_of_powers(relative: PETSc.Mat, frames: PETSc.Mat) -> PETSc.Mat:
    """Return (1 + C + C² + …) frames; C is nilpotent since no chain of pairs returns to itself."""
    total, term = frames.copy(), frames
    while relative.norm() > 0:
        following = relative.matMult(term)
        term.destroy()
        term = following
        if term.norm() == 0:
            break
        total.axpy(1.0, term)
    term.destroy()
    return total
