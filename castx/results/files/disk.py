"""Failures of the disk, which strike one rank, raised on all of them together."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from mpi4py import MPI

from castx.errors import StorageError


class Disk:
    """Remembers what the disk did not take until all ranks can stop for it.

    Args:
        comm: ranks.
    """

    def __init__(self, comm: MPI.Intracomm) -> None:
        self._comm = comm
        self._failure = ""

    @contextmanager
    def writing(self) -> Iterator[None]:
        """Keep an OSError inside for `settle`; nothing collective may stand behind what fails."""
        try:
            yield
        except OSError as error:
            self._failure = self._failure or description_of(error)

    def settle(self) -> None:
        """Raise what has failed on any rank; collective.

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
    """Return what failed in the words of the system, with the file where it is known."""
    return f"cannot write {error.filename or 'results'}: {error.strerror or error}"
