"""The checkpoint file of a run, written and read on any number of ranks."""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

from mpi4py import MPI

import numpy as np

from castx.checkpoint.archive import (
    ArchivedArray,
    arranged,
    read_contents,
    read_verified,
    write_contents,
)
from castx.checkpoint.checksums import shifted
from castx.checkpoint.chunks import Bytes, ChunkedRows
from castx.checkpoint.shared_file import SharedFile
from castx.errors import CaseError, StorageError
from castx.ranks import on_first_rank
from castx.results.files.folder import CHECKPOINT
from castx.stateful import Array, Saved

FILE = "state.npz"


class Checkpoint:
    """The checkpoint file of a results folder.

    Args:
        results: the results folder.
        comm: ranks of the run.
    """

    def __init__(self, results: Path, comm: MPI.Intracomm) -> None:
        self.path = results / CHECKPOINT / FILE
        self._comm = comm

    def write(self, state: Mapping[str, Saved], header: Mapping[str, Any]) -> None:
        """Replace the checkpoint; the old one stays until the new one is complete; collective.

        Args:
            state: arrays of all objects with a state, of the same names on all ranks.
            header: other values, as JSON knows them; those of rank 0 count.

        Raises:
            StorageError: it cannot be written, and the old one is still there; on all ranks.
        """
        chunked = self._chunked(state, ghosts=False)
        entries = arranged(
            (name, *self._form(saved, chunked[name])) for name, saved in state.items()
        )
        try:
            with SharedFile(self.path, self._comm) as file:
                sums = np.zeros(len(entries), dtype=np.int64)
                for number, entry in enumerate(entries):
                    parts = self._parts(state[entry.name], chunked[entry.name], entry.width)
                    for start, chunk in parts:
                        place = entry.data + start * entry.width
                        file.write(partial(_write_at, place, chunk))
                        following = entry.end - place - chunk.nbytes
                        sums[number] ^= shifted(zlib.crc32(chunk), following)
                self._comm.Allreduce(MPI.IN_PLACE, sums, MPI.BXOR)
                if self._comm.rank == 0:
                    file.write(lambda file: write_contents(file, entries, sums.tolist(), header))
                file.replace(verify=lambda path: read_verified(path, self._comm))
        except OSError as error:
            raise StorageError(
                f"the checkpoint {self.path} cannot be written: {error}; make room for it and "
                "continue with --restart from the last one"
            ) from error

    def _chunked(
        self, state: Mapping[str, Saved], *, ghosts: bool
    ) -> dict[str, ChunkedRows | None]:
        """Return the distribution of the rows of each array, None without entities; collective."""
        of_kind: dict[str, ChunkedRows] = {}
        found: dict[str, ChunkedRows | None] = {}
        for name, saved in state.items():
            kind = saved.numbering
            if kind is not None and kind.name not in of_kind:
                of_kind[kind.name] = ChunkedRows(self._comm, kind, ghosts=ghosts)
            found[name] = None if kind is None else of_kind[kind.name]
        return found

    def _form(
        self, saved: Saved, chunked: ChunkedRows | None
    ) -> tuple[np.dtype[Any], tuple[int, ...]]:
        """Return type and shape of the whole array; collective."""
        values = saved.values
        if chunked is None:
            kind: tuple[np.dtype[Any], tuple[int, ...]]
            kind = self._comm.bcast((values.dtype, values.shape))
            return kind
        # A rank without rows of its own may know nothing of their shape.
        form = (len(values) > 0, values.shape[1:], values.dtype.str)
        _, row, dtype = self._comm.allreduce(form, MPI.MAX)
        return np.dtype(dtype), (chunked.count, *row)

    def _parts(
        self, saved: Saved, chunked: ChunkedRows | None, width: int
    ) -> Iterator[tuple[int, Bytes | Array]]:
        """Yield first row and rows of each part of an array written by this rank; collective."""
        if chunked is not None:
            yield from chunked.collected(saved.values, width)
        elif self._comm.rank == 0:
            yield 0, np.ascontiguousarray(saved.values)

    def read_header(self) -> dict[str, Any] | None:
        """Return the header of the file, None if there is no file; collective.

        Raises:
            CaseError: the file is damaged; on all ranks.
        """
        if not self._comm.bcast(self.path.is_file()):
            return None
        try:
            return read_verified(self.path, self._comm).header
        except ValueError as fault:
            raise CaseError(
                f"the checkpoint {self.path} is damaged: {fault}; put a whole copy in its place, "
                "or start the run anew without --restart"
            ) from fault

    def read(self, header: Mapping[str, Any], state: Mapping[str, Saved]) -> dict[str, Array]:
        """Return the local rows, ghosts included, of the wanted arrays that the file has.

        Args:
            header: of the file.
            state: the arrays of objects as they are built, for names, shapes and numberings.

        Raises:
            CaseError: an array has other rows than wanted; on all ranks.
        """
        wanted = {name: saved for name, saved in state.items() if name in set(header["arrays"])}
        entries = on_first_rank(self._comm, lambda: read_contents(self.path).entries)
        chunked = self._chunked(wanted, ghosts=True)
        with self.path.open("rb") as file:
            return {
                name: self._read(file, entries[name], saved, chunked[name])
                for name, saved in wanted.items()
            }

    def _read(
        self, file: BinaryIO, entry: ArchivedArray, saved: Saved, chunked: ChunkedRows | None
    ) -> Array:
        """Return the local rows of an array; collective."""

        def read(start: int, count: int) -> Bytes:
            file.seek(entry.data + start * entry.width)
            return np.frombuffer(file.read(count * entry.width), dtype=np.uint8)

        if chunked is None:
            whole = read(0, entry.count).view(entry.dtype) if self._comm.rank == 0 else None
            return np.array(self._comm.bcast(whole)).reshape(entry.shape)
        if chunked.count != entry.shape[0]:
            raise CaseError(
                f"{self.path} has {entry.shape[0]} rows of {entry.name}, and the case "
                f"{chunked.count}; run the case anew without --restart"
            )
        rows = chunked.handed_out(entry.width, read).view(entry.dtype)
        return rows.reshape(len(rows), *saved.values.shape[1:])


def _write_at(place: int, values: Bytes | Array, file: BinaryIO) -> None:
    file.seek(place)
    file.write(values)
