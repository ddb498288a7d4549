"""Stiffness of full pockets: the block of one pressure for a whole pocket in the Jacobian.

The pressure of a full pocket follows from its volume, P = κ (mean(∇·u) − …), so that it ties all
displacements round the pocket to each other,

    dR = Σ_k c_k (κ_k/V_k) (b_kᵀ du),   b_k = ∫_k ∇·η,   c_k = ∂R/∂P_k.

The block is dense and of rank one for each pocket, and is applied without a matrix.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray, IntArray
from castx.domain.measures import nodal_sum
from castx.domain.mesh import BodyMesh
from castx.mechanics.midsides.midsides import Midsides


class PocketStiffness:
    """Applies the stiffness of the full pockets of one body.

    Args:
        comm: ranks that share the body.
        block_size: unknowns of a node.
    """

    def __init__(self, comm: MPI.Intracomm, block_size: int) -> None:
        self._comm, self._size = comm, block_size
        self._rows: FloatArray = np.zeros((0, block_size))
        self._columns: FloatArray = self._rows
        self._nodes: IntArray = np.zeros(0, dtype=np.int32)
        self._pocket: IntArray = self._nodes
        self.stiffness: FloatArray = np.zeros(0)  # κ/V of each pocket, zero where it has pores

    def begin(self, pocket: IntArray, rows: FloatArray, columns: FloatArray) -> None:
        """Take over the pockets of a trial step.

        Pockets have no node in common, so that the vectors of all of them make one.

        Args:
            pocket: number of the pocket of each owned node, −1: none, shape (owned nodes,).
            rows: the sum of all b_k, shape (owned unknowns,).
            columns: that of all c_k, likewise.
        """
        self._nodes = np.flatnonzero(pocket >= 0).astype(np.int32)
        self._pocket = pocket[self._nodes]
        self._rows = rows.reshape(-1, self._size)[self._nodes]
        self._columns = columns.reshape(-1, self._size)[self._nodes]

    @property
    def exists(self) -> bool:
        """Whether any pocket is full, on any rank."""
        return bool(self.stiffness.any())

    def add_product(self, x: FloatArray, y: FloatArray) -> None:
        """Add the stiffness times owned unknowns x of the body to its rows y; collective."""
        if not self.exists:
            return
        count = self._size * (1 + int(self._nodes.max(initial=-1)))
        given = x[:count].reshape(-1, self._size)[self._nodes]
        volumes = np.einsum("ni,ni->n", self._rows, given)
        change = np.bincount(self._pocket, volumes, len(self.stiffness)).astype(np.float64)
        change = self.stiffness * self._comm.allreduce(change, op=MPI.SUM)
        y[:count].reshape(-1, self._size)[self._nodes] += (
            change[self._pocket][:, None] * self._columns
        )


def pockets_of_nodes(body: BodyMesh, pocket: IntArray) -> IntArray:
    """Return the number of the pocket of each owned node, −1: none, (owned nodes,); collective.

    Args:
        body: mesh of the body.
        pocket: that of each cell, shape (cells,); pockets have no node in common.
    """
    nodes, count = body.nodes.dofmap.list[: body.cell_numbering.owned], len(body.parent_vertices)
    found = _pockets_of(nodes, pocket, count, partial(nodal_sum, body))
    return found[: body.nodes.dofmap.index_map.size_local]


def pockets_of_midsides(midsides: Midsides, pocket: IntArray) -> IntArray:
    """Return the number of the pocket of each owned mid-side, −1: none; collective.

    Args:
        midsides: of the body.
        pocket: that of each cell, shape (cells,); pockets have no node in common.
    """
    owned = midsides.cell_midsides[: midsides.owned_cells]
    found = _pockets_of(owned, pocket, midsides.count, midsides.sum)
    return found[: midsides.owned_midsides]


def _pockets_of(
    places: Any, pocket: IntArray, count: int, sums: Callable[[FloatArray], FloatArray]
) -> IntArray:
    """Return the pocket round each local place, −1: none.

    Args:
        places: numbers of those of the owned cells, shape (owned cells, places of a cell).
        pocket: that of each cell.
        count: number of local places.
        sums: returns the sums over all ranks of values at the local places.
    """
    owned = pocket[: len(places)]
    inside = owned >= 0
    here = np.zeros((2, count))
    np.add.at(here, (0, places[inside]), 1.0)
    np.add.at(here, (1, places[inside]), owned[inside][:, None])
    number, total = (sums(values) for values in here)
    found = np.where(number > 0, np.round(total / np.maximum(number, 1.0)), -1.0)
    return found.astype(np.int32)
