"""Exchange of numbered rows between all ranks and the first one."""

from __future__ import annotations

from collections.abc import Iterator

from mpi4py import MPI

import numpy as np
import numpy.typing as npt

from castx.arrays import LongArray
from castx.stateful import Array, Numbering

CHUNK = 64 * 2**20
"""Bytes in one message at most."""


class Gathering:
    """Moves rows of numbered entities between the ranks and the first of them.

    Args:
        comm: ranks.
    """

    def __init__(self, comm: MPI.Intracomm) -> None:
        self._comm = comm
        self._known: dict[str, list[LongArray]] = {}

    def to_first(self, values: Array, numbering: Numbering) -> Array | None:
        """Return the rows of all owned entities by ascending number on rank 0, else None."""
        rows = np.ascontiguousarray(values[: numbering.owned])
        order = self._numbers(numbering)
        shapes = self._comm.gather(rows.shape[1:])
        if self._comm.rank > 0:
            for part in _chunks(rows):
                self._comm.Send(_bytes(part), dest=0)
            return None
        sizes = [len(numbers) for numbers in order]
        # A rank without rows of its own may know nothing of their shape.
        shape = next((s for s, n in zip(shapes or [], sizes, strict=True) if n), rows.shape[1:])
        gathered = np.empty((sum(sizes), *shape), dtype=rows.dtype)
        filled = 0
        for rank, size in enumerate(sizes):
            part = gathered[filled : filled + size]
            filled += size
            if rank == 0 and size > 0:
                part[:] = rows
            elif rank > 0:
                for chunk in _chunks(part):
                    self._comm.Recv(_bytes(chunk), source=rank)
        return gathered[np.argsort(np.concatenate(order), kind="stable")]

    def _numbers(self, numbering: Numbering) -> list[LongArray]:
        """Return the owned numbers of all ranks on rank 0, unspecified on others."""
        if numbering.name not in self._known:
            own = numbering.numbers[: numbering.owned]
            self._known[numbering.name] = self._comm.gather(own) or []
        return self._known[numbering.name]

    def from_first(self, gathered: Array | None, like: Array, numbering: Numbering) -> Array:
        """Return the rows of all local entities, ghosts included.

        Args:
            gathered: what `to_first` returned, on rank 0.
            like: local rows whose type and shape are wanted.
            numbering: of the local entities.
        """
        known = self._numbers(numbering)
        wanted = self._comm.gather(numbering.numbers)
        found = np.empty((len(numbering.numbers), *like.shape[1:]), dtype=like.dtype)
        if self._comm.rank > 0:
            for part in _chunks(found):
                self._comm.Recv(_bytes(part), source=0)
            return found
        assert gathered is not None and wanted is not None
        ascending = np.sort(np.concatenate(known))
        for rank, numbers in enumerate(wanted):
            rows = gathered[np.searchsorted(ascending, numbers)]
            if rank == 0 and len(numbers):
                found[:] = rows
            elif rank > 0:
                for part in _chunks(np.ascontiguousarray(rows)):
                    self._comm.Send(_bytes(part), dest=rank)
        return found


def _chunks(rows: Array) -> Iterator[Array]:
    """Yield parts of contiguous rows, none larger than a message."""
    size = max(1, int(rows.dtype.itemsize * np.prod(rows.shape[1:])))
    step = max(1, CHUNK // size)
    for start in range(0, len(rows), step):
        yield rows[start : start + step]


def _bytes(rows: Array) -> npt.NDArray[np.uint8]:
    """Return the memory of contiguous rows."""
    return rows.reshape(-1).view(np.uint8)
