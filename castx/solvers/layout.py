"""Numbering of one PETSc vector that holds the unknowns of all bodies."""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
from dolfinx.common import IndexMap
from dolfinx.fem import Function
from numpy.typing import ArrayLike, NDArray

from castx.arrays import IntArray
from castx.solvers.communicator import keep_duplicate


class Layout:
    """Numbers the unknowns of all bodies as a PETSc nest does.

    Each rank has its part of body 0, then of body 1, and so on.

    Args:
        comm: ranks.
        node_maps: distribution of the nodes of each body.
        block_sizes: unknowns per node of each body.

    Attributes:
        first: global number of the first unknown of this rank.
        size_local: number of unknowns of this rank.
        size_global: number of all unknowns.
        offsets: where each body starts among the unknowns of this rank.
    """

    def __init__(
        self, comm: MPI.Intracomm, node_maps: Sequence[IndexMap], block_sizes: Sequence[int]
    ) -> None:
        keep_duplicate(comm)
        self.comm = comm
        self.block_sizes = tuple(block_sizes)
        nodes = np.array([node_map.size_local for node_map in node_maps], dtype=np.int64)
        counts = np.array(comm.allgather(nodes)).reshape(comm.size, -1)
        unknowns = counts * np.array(self.block_sizes, dtype=np.int64)
        self._first_nodes = np.cumsum(counts, axis=0) - counts
        self._rank_starts = np.cumsum(unknowns.sum(axis=1)) - unknowns.sum(axis=1)
        self._starts = self._rank_starts[:, None] + np.cumsum(unknowns, axis=1) - unknowns
        self.first = int(self._rank_starts[comm.rank])
        self._sizes = unknowns[comm.rank]
        self.size_local = int(unknowns[comm.rank].sum())
        self.size_global = int(unknowns.sum())
        self.offsets = tuple(int(o) for o in np.cumsum(self._sizes) - self._sizes)

    def dofs(
        self, body: int, nodes: ArrayLike, component: int | NDArray[np.integer] = 0
    ) -> IntArray:
        """Return the global numbers of one unknown of nodes, whichever rank owns them, shape (n,).

        Args:
            body: number of the body.
            nodes: global numbers of its nodes, shape (n,).
            component: number of the unknown at its node, one or one for each node, shape (n,).
        """
        nodes = np.asarray(nodes, dtype=np.int64)
        first = self._first_nodes[:, body]
        owner = np.searchsorted(first, nodes, side="right") - 1
        within = (nodes - first[owner]) * self.block_sizes[body] + component
        numbers: IntArray = (self._starts[owner, body] + within).astype(np.int32)
        return numbers

    def local_slice(self, body: int) -> slice:
        """Return where the unknowns of a body lie among those of this rank."""
        return slice(self.offsets[body], self.offsets[body] + int(self._sizes[body]))

    def index_sets(self) -> list[PETSc.IS]:
        """Return the owned global numbers of each body, with its block size."""
        sets = []
        for body, block_size in enumerate(self.block_sizes):
            first = int(self._starts[self.comm.rank, body])
            part = PETSc.IS().createStride(int(self._sizes[body]), first, 1, comm=self.comm)
            part.setBlockSize(block_size)
            sets.append(part)
        return sets

    def create_vector(self) -> PETSc.Vec:
        """Return a zero vector of all bodies; the caller destroys it."""
        return PETSc.Vec().createMPI((self.size_local, self.size_global), comm=self.comm)

    def to_functions(self, vector: PETSc.Vec, functions: Sequence[Function]) -> None:
        """Copy the parts of a vector into a function of each body and update ghosts; collective."""
        values = vector.getArray(readonly=True)
        for body, function in enumerate(functions):
            function.x.array[: self._sizes[body]] = values[self.local_slice(body)]
            function.x.scatter_forward()
