"""A file that all ranks write side by side, and that replaces another one when it is whole.

It is written by the plain calls of the system. MPI-IO hides why a write fails, and on a network
file system it needs locks that many do not have. The name is a new one each time: a client of a
network file system may take an old name for what it was before, the last whole file.
"""

from __future__ import annotations

import os
import secrets
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

from mpi4py import MPI

NEW = ".new"


class SharedFile:
    """A file that is written beside the one it replaces; collective, as is leaving it.

    A rank that fails writes nothing more and goes on, so that none waits for it for ever.

    Args:
        path: the file to replace.
        comm: ranks.
    """

    def __init__(self, path: Path, comm: MPI.Intracomm) -> None:
        self._path, self._comm = path, comm
        self.new = path.with_name(comm.bcast(f"{path.name}{NEW}-{secrets.token_hex(8)}"))
        self._file: BinaryIO | None = None
        self._failure = ""

    def __enter__(self) -> Self:
        if self._comm.rank == 0:
            with self._trying():
                self._path.parent.mkdir(exist_ok=True)
                self._remove_new()
                self._file = self.new.open("xb")
        self._comm.Barrier()
        if self._comm.rank > 0:
            with self._trying():
                self._file = os.fdopen(os.open(self.new, os.O_WRONLY), "wb")
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._file is not None:
            with suppress(OSError):  # what it could not write before it tries to write again
                self._file.close()
        if self._comm.rank == 0:
            with suppress(OSError):
                self._remove_new()

    def _remove_new(self) -> None:
        """Remove files that were not finished, those of killed runs too."""
        for left in self._path.parent.glob(f"{self._path.name}{NEW}*"):
            left.unlink()

    @contextmanager
    def _trying(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            self._failure = self._failure or error.strerror or str(error)

    def write(self, action: Callable[[BinaryIO], object]) -> None:
        """Let this rank write into the file by an action, unless it has failed before."""
        if self._file is not None and not self._failure:
            with self._trying():
                action(self._file)

    def replace(self, verify: Callable[[Path], object]) -> None:
        """Bring all to disk, verify it and replace the old file; collective.

        Args:
            verify: raises a ValueError, on all ranks, when the file at a path is not whole.

        Raises:
            OSError: of any rank, and then the old file is still there; on all ranks.
        """
        self.write(_to_disk)
        self._raise_failures()
        try:
            verify(self.new)
        except ValueError as fault:
            raise OSError(f"what was written does not read back: {fault}") from fault
        if self._comm.rank == 0:
            with self._trying():
                self.new.replace(self._path)
                _sync_folder(self._path.parent)
        self._raise_failures()

    def _raise_failures(self) -> None:
        failures = [failure for failure in self._comm.allgather(self._failure) if failure]
        if failures:
            raise OSError(failures[0])


def _to_disk(file: BinaryIO) -> None:
    file.flush()
    os.fsync(file.fileno())
    file.close()


def _sync_folder(folder: Path) -> None:
    """Bring the names in a folder to disk."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
