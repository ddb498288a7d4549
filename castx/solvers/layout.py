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


class Layout:
    """Each rank holds its part of body 0, then of body 1, and so on: the order of a PETSc nest.

    Args:
        comm: ranks.
        node_maps: distribution of the nodes of each body.
        block_sizes: unknowns per node of each body.
    """

    def __init__(
        self, comm: MPI.Intracomm, node_maps: Sequence[IndexMap], block_sizes: Sequence[int]
    ) -> None:
        """Gather the ranges of all ranks."""
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

    def dofs(self, body: int, nodes: ArrayLike, component: int | NDArray = 0) -> IntArray:
        """Global indices of one component at global nodes of a body, whichever rank owns them.

        Args:
            body: index of the body.
            nodes: (n,) global node numbers.
            component: one number, or (n,).
        """
        nodes = np.asarray(nodes, dtype=np.int64)
        first = self._first_nodes[:, body]
        owner = np.searchsorted(first, nodes, side="right") - 1
        within = (nodes - first[owner]) * self.block_sizes[body] + component
        return (self._starts[owner, body] + within).astype(np.int32)

    def local_slice(self, body: int) -> slice:
        """Where the owned part of a body lies in the local array."""
        return slice(self.offsets[body], self.offsets[body] + int(self._sizes[body]))

    def index_sets(self) -> list[PETSc.IS]:
        """The owned global indices of each body, with its block size."""
        sets = []
        for body, block_size in enumerate(self.block_sizes):
            first = int(self._starts[self.comm.rank, body])
            part = PETSc.IS().createStride(int(self._sizes[body]), first, 1, comm=self.comm)
            part.setBlockSize(block_size)
            sets.append(part)
        return sets

    def create_vector(self) -> PETSc.Vec:
        """A zero vector of all bodies; the caller destroys it."""
        return PETSc.Vec().createMPI((self.size_local, self.size_global), comm=self.comm)

    def to_functions(self, vector: PETSc.Vec, functions: Sequence[Function]) -> None:
        """Copy the parts of a vector into one function per body and update their ghosts."""
        values = vector.getArray(readonly=True)
        for body, function in enumerate(functions):
            function.x.array[: self._sizes[body]] = values[self.local_slice(body)]
            function.x.scatter_forward()

    def from_functions(self, functions: Sequence[Function], vector: PETSc.Vec) -> None:
        """Copy the owned values of one function per body into a vector."""
        with vector as values:
            for body, function in enumerate(functions):
                values[self.local_slice(body)] = function.x.array[: self._sizes[body]]
