"""A body whose parts on all ranks are brought together on rank 0, in an order without ranks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mpi4py import MPI

import numpy as np
import numpy.typing as npt

from castx.arrays import FloatArray, LongArray
from castx.results.files.vtu import Piece

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh

Rows = npt.NDArray[Any]


@dataclass(frozen=True, eq=False)
class GatheredBody:
    """A body on rank 0, with points and cells in the order of the mesh before it was distributed.

    Args:
        comm: ranks.
        whole: the body on rank 0; without cells on the others.
        points: rows of the points of `whole` among those of all ranks; empty on the others.
        cells: rows of its cells; empty on the others.
    """

    comm: MPI.Intracomm
    whole: Piece
    points: LongArray
    cells: LongArray

    @classmethod
    def of(cls, comm: MPI.Intracomm, body: BodyMesh, piece: Piece) -> GatheredBody:
        """Bring the parts of a body together; collective.

        Args:
            comm: ranks.
            body: the body.
            piece: its part on this rank.
        """
        numbers = body.original_nodes[piece.nodes]
        corners = numbers[piece.connectivity].astype(np.int64)
        width = comm.allreduce(corners.size // max(piece.cells, 1), MPI.MAX)
        nodes = gathered_rows(comm, numbers.astype(np.int64))
        cells = gathered_rows(comm, body.original_cells[: piece.cells].astype(np.int64))
        places = gathered_rows(comm, piece.points)
        rows = gathered_rows(comm, corners.reshape(piece.cells, width))
        kind = comm.allreduce(piece.kind, MPI.MAX)
        known, point_order = np.unique(nodes, return_index=True)
        cell_order = np.argsort(cells)
        whole = Piece(
            cells=len(cells),
            nodes=known,
            points=places[point_order],
            connectivity=np.searchsorted(known, rows[cell_order].ravel()),
            kind=kind,
        )
        return cls(comm, whole, point_order, cell_order)

    def nodal(self, values: FloatArray) -> FloatArray:
        """Return a field at all points, on rank 0; collective.

        Args:
            values: at the points of this rank, (points,) or with columns.
        """
        return gathered_rows(self.comm, values)[self.points]

    def cellwise(self, values: FloatArray) -> FloatArray:
        """Return a field in all cells, on rank 0; collective.

        Args:
            values: in the cells of this rank, (cells,) or with columns.
        """
        return gathered_rows(self.comm, values)[self.cells]


def gathered_rows(comm: MPI.Intracomm, rows: Rows) -> Rows:
    """Return the rows of all ranks on rank 0, none on the others; collective.

    Args:
        comm: ranks.
        rows: of this rank, of the same type and columns on all of them.
    """
    counts = comm.gather(rows.size)
    total = 0 if counts is None else sum(counts)
    width = int(np.prod(rows.shape[1:], dtype=np.int64))
    found = np.empty((total // width, *rows.shape[1:]), dtype=rows.dtype)
    comm.Gatherv(np.ascontiguousarray(rows), None if counts is None else (found, counts))
    return found
