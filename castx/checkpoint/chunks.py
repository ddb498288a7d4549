"""Numbered rows in chunks by ascending number, each on one rank, whatever the ranks own.

No rank ever holds more than one chunk and what it owns. First all ranks find out which place each
of their numbers has among all numbers: each rank looks after a range of numbers, is sent those that
are owned, sorts them and answers for them. Then the rows travel in rounds: in each of them a rank
fills, or hands out, one chunk, so that no message is large.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

from mpi4py import MPI

import numpy as np
import numpy.typing as npt

from castx.arrays import LongArray
from castx.stateful import Array, Numbering

ROWS = 2**16
"""Rows of a chunk: enough for one write, and whole pages of memory whatever the type of the rows,
so that no page of a file is written by two ranks."""

Bytes = npt.NDArray[np.uint8]


class _Round(NamedTuple):
    """Rows exchanged while each rank has one chunk.

    Attributes:
        rows: local rows, by ascending number.
        counts: how many of them belong to the chunk of each rank.
        chunk_counts: how many rows of the chunk of this rank each rank has.
        places: of these in the chunk.
    """

    rows: LongArray
    counts: LongArray
    chunk_counts: LongArray
    places: LongArray


class ChunkedRows:
    """Moves rows between the owners of entities and the owners of chunks.

    Chunk k is that of rank k modulo the number of ranks. Collective, as are all methods.

    Args:
        comm: ranks.
        numbering: of the local entities.
        ghosts: whether ghosts take rows as well, which are only read then.

    Attributes:
        count: owned entities of all ranks.
    """

    def __init__(self, comm: MPI.Intracomm, numbering: Numbering, *, ghosts: bool) -> None:
        self._comm = comm
        places, self.count = _places(comm, numbering)
        self._local = len(places) if ghosts else numbering.owned
        order = np.argsort(places[: self._local], kind="stable")
        in_all = places[order]
        self._rounds: list[_Round] = []
        for first in range(0, -(-self.count // ROWS), comm.size):
            ends = np.searchsorted(in_all, ROWS * (first + np.arange(comm.size + 1)))
            here, counts = slice(ends[0], ends[-1]), np.diff(ends)
            chunk_counts = _swapped(comm, counts)
            of_chunk = _exchanged(comm, in_all[here], counts, chunk_counts)
            places_in_chunk = of_chunk - ROWS * (first + comm.rank)
            self._rounds.append(_Round(order[here], counts, chunk_counts, places_in_chunk))

    def _own(self) -> Iterator[tuple[_Round, int, int]]:
        """Yield each round with the first row and the number of rows of the chunk of this rank."""
        for number, round_ in enumerate(self._rounds):
            start = ROWS * (number * self._comm.size + self._comm.rank)
            yield round_, start, min(max(self.count - start, 0), ROWS)

    def collected(self, values: Array, width: int) -> Iterator[tuple[int, Bytes]]:
        """Yield the chunks of this rank, each with its first row.

        Args:
            values: rows of the owned entities; others may follow. A rank that has none need not
                know their shape.
            width: bytes of a row.
        """
        rows = _bytes(values[: self._local], width)
        for round_, start, count in self._own():
            found = _exchanged(self._comm, rows[round_.rows], round_.counts, round_.chunk_counts)
            chunk = np.empty((count, width), dtype=np.uint8)
            chunk[round_.places] = found
            if count:
                yield start, chunk

    def handed_out(self, width: int, read: Callable[[int, int], Bytes]) -> Bytes:
        """Return the bytes of the local rows, shape (rows, width).

        Args:
            width: bytes of a row.
            read: returns rows of a chunk of this rank, of its first row and their number.
        """
        rows = np.empty((self._local, width), dtype=np.uint8)
        for round_, start, count in self._own():
            chunk = read(start, count).reshape(count, width)
            asked = chunk[round_.places]
            rows[round_.rows] = _exchanged(self._comm, asked, round_.chunk_counts, round_.counts)
        return rows


def _places(comm: MPI.Intracomm, numbering: Numbering) -> tuple[LongArray, int]:
    """Return the places of the local numbers among all owned ones, and the number of places."""
    own = numbering.numbers[: numbering.owned]
    limits = np.iinfo(np.int64)
    lowest = comm.allreduce(int(own.min(initial=limits.max)), MPI.MIN)
    highest = comm.allreduce(int(own.max(initial=limits.min)), MPI.MAX)
    width = max(highest - lowest, 0) // comm.size + 1

    def by_keeper(numbers: LongArray) -> tuple[LongArray, LongArray, LongArray]:
        """Return the order by keeper, and how many each keeper gets from here and from others."""
        keeper = (numbers - lowest) // width
        counts = np.bincount(keeper, minlength=comm.size)
        return np.argsort(keeper, kind="stable"), counts, _swapped(comm, counts)

    order, counts, kept_counts = by_keeper(own)
    kept = np.sort(_exchanged(comm, own[order], counts, kept_counts))
    before = comm.scan(len(kept)) - len(kept)
    order, counts, kept_counts = by_keeper(numbering.numbers)
    asked = _exchanged(comm, numbering.numbers[order], counts, kept_counts)
    answers = before + np.searchsorted(kept, asked)
    places = np.empty(len(numbering.numbers), dtype=np.int64)
    places[order] = _exchanged(comm, answers, kept_counts, counts)
    return places, comm.allreduce(len(own))


def _swapped(comm: MPI.Intracomm, counts: LongArray) -> LongArray:
    """Return the number of rows that each rank has for the present one."""
    swapped = np.empty_like(counts)
    comm.Alltoall(counts, swapped)
    return swapped


def _exchanged(comm: MPI.Intracomm, rows: Array, counts: LongArray, awaited: LongArray) -> Array:
    """Return the rows of all ranks for this one, by rank.

    Args:
        comm: ranks.
        rows: those that leave, by rank.
        counts: how many go to each rank.
        awaited: how many come from each rank.
    """
    found = np.empty((awaited.sum(), *rows.shape[1:]), dtype=rows.dtype)
    # Counts are of rows, since those of bytes may be too many for 32 bits.
    row = MPI.BYTE.Create_contiguous(rows.dtype.itemsize * int(np.prod(rows.shape[1:]))).Commit()
    comm.Alltoallv([np.ascontiguousarray(rows), counts, row], [found, awaited, row])
    row.Free()
    return found


def _bytes(rows: Array, width: int) -> Bytes:
    """Return the memory of rows of a number of bytes, shape (rows, width)."""
    return np.ascontiguousarray(rows).reshape(-1).view(np.uint8).reshape(len(rows), width)
