"""Matrices between the displacements of all bodies and the unknowns of a constraint transform."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt
from scipy import sparse

from castx.arrays import BoolArray, FloatArray, IntArray, LongArray
from castx.contact.kinematics.node_rows import NodeRows
from castx.contact.kinematics.pair_rows import EqualMotion
from castx.solvers.layout import Layout


class BasisMatrices:
    """R and P of v = R u and u = P v, filled node by node, then by motions relative to other nodes.

    Entries are gathered first: PETSc then takes each matrix at once, with its places known.

    Args:
        layout: numbering of the displacements (and pressures) of all bodies.
        dimension: number of displacement components.
        rows: rows of the nodes of each body; those of nodes that have any are completed to a basis.
    """

    def __init__(self, layout: Layout, dimension: int, rows: Sequence[NodeRows]) -> None:
        self._layout, self._dimension, self._rows = layout, dimension, list(rows)
        self._forward, self._frames, self._relative = (_Entries(layout) for _ in range(3))
        self._facing = _Entries(layout)
        self._duals = [self._fill_frames(b) for b in range(len(self._rows))]

    def _first(self, b: int) -> int:
        return self._layout.first + int(self._layout.local_slice(b).start)

    def _fill_frames(self, b: int) -> FloatArray:
        """Fill the frames of the nodes of a body; return their dual bases as columns."""
        rows, d, size = self._rows[b], self._dimension, self._layout.block_sizes[b]
        inverse = np.tile(np.eye(d), (len(rows.count), 1, 1))
        special = rows.complete()
        inverse[special] = np.linalg.inv(rows.rows[special])
        part = self._layout.local_slice(b)
        plain: BoolArray = np.ones((len(rows.count), size), dtype=bool)
        plain[special, :d] = False
        unchanged = self._first(b) + np.arange(part.stop - part.start)[plain.ravel()]
        dofs = self._first(b) + special[:, None] * size + np.arange(d)
        for matrix, frames in ((self._forward, rows.rows), (self._frames, inverse)):
            matrix.add(unchanged, unchanged, 1.0)
            matrix.add(dofs[:, :, None], dofs[:, None, :], frames[special])
        return inverse

    def tie(self, motion: EqualMotion) -> IntArray:
        """Take a row of nodes relative to the first one; return the local numbers that are zero."""
        b, nodes, slots = motion.body, motion.nodes, motion.slots
        comm, d, size = self._layout.comm, self._dimension, self._layout.block_sizes[b]
        starts = (self._first(b) + nodes * size).astype(np.int32)
        columns = starts[:, None] + np.arange(d, dtype=np.int32)
        own = starts + slots
        i = motion.first
        firsts = comm.allgather(
            None if i is None else (own[i], columns[i], self._rows[b].rows[nodes[i], slots[i]])
        )
        found = next((entry for entry in firsts if entry is not None), None)
        if found is None:
            return np.zeros(0, dtype=np.int32)
        first, first_columns, row = found
        others = np.flatnonzero(own != first)
        self._forward.add(own[others, None], first_columns[None], -row[None])
        duals = self._duals[b][nodes[others], :, slots[others]]
        self._frames.add(columns[others], first, duals)
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
        self._forward.add(others, first, -1.0)
        self._frames.add(others, first, 1.0)
        return np.asarray(others - self._layout.first, dtype=np.int32)

    def follow(self, motion: EqualMotion, other: int) -> None:
        """Let nodes that move equally go with what ties the first of them, which has its own pair.

        Args:
            motion: the nodes.
            other: number of the body to which the first one is tied.
        """
        b, nodes, slots, i = motion.body, motion.nodes, motion.slots, motion.first
        mine = None
        if i is not None and motion.tied_by is not None:
            faced, weights = (part[motion.pair] for part in motion.tied_by.partners)
            mine = (faced, weights, self._rows[b].rows[nodes[i], slots[i]])
        faced, weights, row = next(found for found in self._layout.comm.allgather(mine) if found)
        others = np.flatnonzero(np.arange(len(nodes)) != (-1 if i is None else i))
        components = range(self._dimension)
        starts = self._first(b) + nodes[others] * self._layout.block_sizes[b]
        columns = np.stack([self._layout.dofs(other, faced, k) for k in components], axis=1)
        duals = self._duals[b][nodes[others], :, slots[others]]
        self._relative.add(
            (starts[:, None] + np.arange(self._dimension))[:, :, None, None],
            columns,
            duals[:, :, None, None] * (weights[:, None] * row),
        )

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
        starts = self._first(b) + nodes * self._layout.block_sizes[b]
        rows = local + self._layout.first
        duals = self._duals[b][nodes, :, rows - starts]
        weighted = weights[:, :, None] * directions[:, None]
        for matrix in (self._forward, self._facing):
            matrix.add(rows[:, None, None], columns, -weighted)
        # Several rows of one pair add up.
        self._relative.add(
            (starts[:, None] + components)[:, None, :, None],
            columns[:, :, None],
            duals[:, None, :, None] * weighted[:, :, None],
        )

    def finish(self) -> tuple[PETSc.Mat, PETSc.Mat]:
        """Return R and P; the caller destroys them."""
        relative = self._relative.matrix()
        to_displacements = _sum_of_powers(relative, self._frames.matrix())
        relative.destroy()
        return self._forward.matrix(), to_displacements

    def coupling(self, P: PETSc.Mat) -> PETSc.Mat | None:
        """Return the part of R for the motion of the facing points, times P; collective.

        Args:
            P: of `finish`.

        Returns:
            That part of R times P, which the caller destroys; None where no row is relative.
        """
        facing, product = self._facing.matrix(), None
        if facing.norm() > 0:
            product = facing.matMult(P)
        facing.destroy()
        return product


class _Entries:
    """Entries of a square matrix in the layout, of owned rows; entries at one place add up."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        none = np.zeros(0, dtype=np.int64)
        self._parts: list[list[npt.NDArray[Any]]] = [[none, none, np.zeros(0)]]

    def add(self, rows: Any, columns: Any, values: Any) -> None:
        """Add values at global rows and columns, arrays that broadcast to one shape."""
        found = np.broadcast_arrays(rows, columns, values)
        self._parts.append([part.ravel() for part in found])

    def matrix(self) -> PETSc.Mat:
        """Return the matrix; collective."""
        local, everywhere = self._layout.size_local, self._layout.size_global
        rows, columns, values = (np.concatenate(parts) for parts in zip(*self._parts, strict=True))
        places = rows - self._layout.first, columns
        table = sparse.coo_array((values, places), shape=(local, everywhere)).tocsr()
        pattern = (part.astype(PETSc.IntType) for part in (table.indptr, table.indices))
        return PETSc.Mat().createAIJ(
            ((local, everywhere),) * 2, csr=(*pattern, table.data), comm=self._layout.comm
        )


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
