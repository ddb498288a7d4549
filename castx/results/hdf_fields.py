"""Fields as one growing VTKHDF file for each body, written by rank 0."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from castx.results.field_copies import FieldCopies
from castx.results.files.disk import Disk
from castx.results.files.folder import ENDING
from castx.results.files.vtkhdf import BodyFile
from castx.results.files.vtu import Piece
from castx.results.gathered import GatheredBody

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh


@dataclass(frozen=True)
class WrittenBodies:
    """A moment on disk.

    Attributes:
        time: [s].
        bodies: those that were there.
    """

    time: float
    bodies: Sequence[str]


class HdfFields:
    """Fields as one file for each body, to which every moment is appended; collective.

    Args:
        folder: of the files.
        mesh: the bodies.
        pieces: their parts on this rank.
        units: of the fields, by their names in the files.
        disk: takes the failures of single ranks.
    """

    def __init__(
        self,
        folder: Path,
        mesh: CastingMesh,
        pieces: Mapping[str, Piece],
        units: Mapping[str, str],
        disk: Disk,
    ) -> None:
        self._folder, self._comm, self._disk = folder, mesh.comm, disk
        self._bodies = {
            name: GatheredBody.of(mesh.comm, mesh.bodies[name], piece)
            for name, piece in pieces.items()
        }
        self._files = {
            name: BodyFile(folder / f"{name}{ENDING}", name, number, body.whole, units)
            for number, (name, body) in enumerate(self._bodies.items())
        }
        self._outputs: list[WrittenBodies] = []

    @property
    def last(self) -> float | None:
        """Time of the last moment on disk [s]; None: there is none."""
        return self._outputs[-1].time if self._outputs else None

    def write(self, state: FieldCopies) -> None:
        """Append the fields of a later moment; collective.

        Raises:
            StorageError: the disk did not take it; on all ranks.
        """
        there = [name for name in self._bodies if name in state.nodal]
        for name in there:
            body = self._bodies[name]
            nodal = {key: body.nodal(values) for key, values in state.nodal[name].items()}
            cellwise = {key: body.cellwise(values) for key, values in state.cellwise[name].items()}
            if self._comm.rank == 0:
                with self._disk.writing():
                    self._files[name].append(state.time, nodal, cellwise)
        self._disk.raise_failures()
        self._outputs.append(WrittenBodies(state.time, there))

    def notes(self) -> list[dict[str, Any]]:
        """Return a description of the written moments, for JSON."""
        return [asdict(output) for output in self._outputs]

    def resume(self, notes: Sequence[Mapping[str, Any]]) -> None:
        """Go on behind the moments of `notes`; later ones are removed."""
        self._outputs = [WrittenBodies(**note) for note in notes]
        if self._comm.rank > 0:
            return
        for name, file in self._files.items():
            file.keep([output.time for output in self._outputs if name in output.bodies])
