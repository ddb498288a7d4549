"""VTU pieces of all bodies, ranks and moments, and the collection that lists them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from html import escape
from pathlib import Path
from typing import Any

from mpi4py import MPI

from castx.results.field_copies import FieldCopies
from castx.results.files.disk import Disk
from castx.results.files.folder import COLLECTION, write_whole
from castx.results.files.vtu import Piece, write_piece


@dataclass(frozen=True)
class WrittenMoment:
    """A moment on disk.

    Attributes:
        time: [s].
        holders: the ranks that had cells of each body.
    """

    time: float
    holders: Mapping[str, Sequence[int]]


class VtuFields:
    """Fields as a file for each body, rank and moment; collective.

    Args:
        folder: of the files.
        comm: ranks.
        pieces: the parts of all bodies on this rank.
        units: of the fields, by their names in the files.
        disk: takes the failures of single ranks.
    """

    def __init__(
        self,
        folder: Path,
        comm: MPI.Intracomm,
        pieces: Mapping[str, Piece],
        units: Mapping[str, str],
        disk: Disk,
    ) -> None:
        self._folder, self._comm, self._disk = folder, comm, disk
        self._pieces, self._units = pieces, units
        filled = comm.allgather([piece.cells > 0 for piece in pieces.values()])
        self._holders = {
            name: [rank for rank, of_rank in enumerate(filled) if of_rank[index]]
            for index, name in enumerate(pieces)
        }
        self._outputs: list[WrittenMoment] = []

    @property
    def last(self) -> float | None:
        """Time of the last moment on disk [s]; None: there is none."""
        return self._outputs[-1].time if self._outputs else None

    def write(self, state: FieldCopies) -> None:
        """Write the fields of a later moment; collective.

        Raises:
            StorageError: the disk did not take it; on all ranks.
        """
        index = len(self._outputs)
        with self._disk.writing():
            for number, (body, piece) in enumerate(self._pieces.items()):
                if piece.cells > 0 and body in state.nodal:
                    path = self._folder / piece_name(body, index, self._comm.rank)
                    fields = state.nodal[body], state.cellwise[body]
                    write_piece(path, piece, number, *fields, body, self._units)
        self._disk.raise_failures()
        holders = {body: ranks for body, ranks in self._holders.items() if body in state.nodal}
        self._outputs.append(WrittenMoment(state.time, holders))
        if self._comm.rank == 0:
            with self._disk.writing():
                self._write_collection()

    def _write_collection(self) -> None:
        write_whole(self._folder / COLLECTION, collection(self._outputs))

    def notes(self) -> list[dict[str, Any]]:
        """Return a description of the written moments, for JSON."""
        return [asdict(output) for output in self._outputs]

    def resume(self, notes: Sequence[Mapping[str, Any]]) -> None:
        """Go on behind the moments of `notes`; pieces of later ones are removed."""
        self._outputs = [WrittenMoment(**note) for note in notes]
        if self._comm.rank > 0:
            return
        known = {name for index, _, name in pieces_of(self._outputs)}
        for path in self._folder.glob("*.vtu"):
            if path.name not in known:
                path.unlink()
        self._write_collection()


def piece_name(body: str, index: int, rank: int) -> str:
    """Return the name of the file of one body, output and rank."""
    return f"{body}_{index:05d}_{rank}.vtu"


def pieces_of(outputs: Sequence[WrittenMoment]) -> Iterator[tuple[int, str, str]]:
    """Yield the number of the output, the body and the name of the file of all pieces."""
    for index, output in enumerate(outputs):
        for body, ranks in output.holders.items():
            for rank in ranks:
                yield index, body, piece_name(body, index, rank)


def collection(outputs: Sequence[WrittenMoment]) -> str:
    """Return the text of the collection of all pieces."""
    lines = ['<VTKFile type="Collection" version="1.0">', "  <Collection>"]
    part, last = 0, -1
    for index, body, name in pieces_of(outputs):
        part, last = part + 1 if index == last else 0, index
        lines.append(
            f'    <DataSet timestep="{outputs[index].time!r}" group="{escape(body)}" '
            f'part="{part}" file="{escape(name)}"/>'
        )
    return "\n".join([*lines, "  </Collection>", "</VTKFile>", ""])
