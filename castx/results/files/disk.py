"""Failures of the disk on one rank, raised on all ranks together."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from mpi4py import MPI

from castx.errors import StorageError


class Disk:
    """Remembers the failure of a write until all ranks can stop for it.

    Args:
        comm: ranks.
    """

    def __init__(self, comm: MPI.Intracomm) -> None:
        self._comm = comm
        self._failure = ""

    @contextmanager
    def writing(self) -> Iterator[None]:
        """Keep an OSError inside for `raise_failures`; nothing collective may follow it."""
        try:
            yield
        except OSError as error:
            self._failure = self._failure or description_of(error)

    def raise_failures(self) -> None:
        """Raise the failure of any rank on all of them; collective.

        Raises:
            StorageError: names the file and the reason; on all ranks.
        """
        failures = [failure for failure in self._comm.allgather(self._failure) if failure]
        self._failure = ""
        if failures:
            raise StorageError(
                f"{failures[0]}; what was written before stays: cure this, then go on from the "
                "last checkpoint with --restart"
            )


def description_of(error: OSError) -> str:
    """Return a failure in the words of the system, with the file if it is known."""
    return f"cannot write {error.filename or 'results'}: {error.strerror or error}"
