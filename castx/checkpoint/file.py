"""The checkpoint file of a run, read on any number of ranks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from mpi4py import MPI

from castx.checkpoint.archive import ArchiveWriter, read_array, read_header
from castx.checkpoint.gathering import Gathering
from castx.errors import StorageError
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
        arrays, failure = self._gathered(state), ""
        if self._comm.rank == 0:
            failure = self._write(arrays, header)
        for _ in arrays:  # the other ranks send all, whatever became of the file
            pass
        failure = self._comm.bcast(failure)
        if failure:
            raise StorageError(
                f"the checkpoint {self.path} cannot be written: {failure}; make room for it and "
                "continue with --restart from the last one"
            )

    def _gathered(self, state: Mapping[str, Saved]) -> Iterator[tuple[str, Array | None]]:
        """Yield the whole arrays on rank 0; collective at each of them."""
        gathering = Gathering(self._comm)
        for name, saved in state.items():
            if saved.numbering is None:
                yield name, saved.values
            else:
                yield name, gathering.to_first(saved.values, saved.numbering)

    def _write(self, arrays: Iterator[tuple[str, Array | None]], header: Mapping[str, Any]) -> str:
        """Write the file on rank 0; return the reason of a failure, empty if there is none."""
        try:
            self.path.parent.mkdir(exist_ok=True)
            with ArchiveWriter(self.path, header) as archive:
                for name, array in arrays:
                    assert array is not None
                    archive.add(name, array)
        except OSError as error:
            return error.strerror or str(error)
        return ""

    def read_header(self) -> dict[str, Any] | None:
        """Return the header of the file, None if there is no file; collective.

        Raises:
            CaseError: the file is damaged; on all ranks.
        """
        return on_first_rank(
            self._comm, lambda: read_header(self.path) if self.path.is_file() else None
        )

    def read(self, header: Mapping[str, Any], state: Mapping[str, Saved]) -> dict[str, Array]:
        """Return the local rows, ghosts included, of the wanted arrays that the file has.

        Args:
            header: of the file.
            state: the arrays of objects as they are built, for names, types and numberings.
        """
        gathering = Gathering(self._comm)
        found: dict[str, Array] = {}
        for name in (name for name in state if name in set(header["arrays"])):
            saved = state[name]
            array = read_array(self.path, name) if self._comm.rank == 0 else None
            if saved.numbering is None:
                found[name] = self._comm.bcast(array)
            else:
                found[name] = gathering.from_first(array, saved.values, saved.numbering)
        return found
