"""The files of the fields of a run: what each format offers, and the choice between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from castx.results.field_copies import FieldCopies
from castx.results.files.disk import Disk
from castx.results.files.vtu import Piece
from castx.results.hdf_fields import HdfFields
from castx.results.vtu_fields import VtuFields

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh


class FieldFiles(Protocol):
    """Files that take the fields of one moment after the other."""

    @property
    def last(self) -> float | None:
        """Time of the last moment on disk [s]; None: there is none."""

    def write(self, state: FieldCopies, /) -> None:
        """Write the fields of a later moment; collective.

        Raises:
            StorageError: the disk did not take it; on all ranks.
        """

    def notes(self) -> list[dict[str, Any]]:
        """Return a description of the written moments, for JSON."""

    def resume(self, notes: Sequence[Mapping[str, Any]], /) -> None:
        """Go on behind the moments of `notes`; later ones are removed."""


def field_files(
    form: str,
    folder: Path,
    mesh: CastingMesh,
    pieces: Mapping[str, Piece],
    units: Mapping[str, str],
    disk: Disk,
) -> FieldFiles:
    """Return the files of a format; collective.

    Args:
        form: one of `castx.case.output.FORMATS`.
        folder: of the files.
        mesh: the bodies.
        pieces: their parts on this rank.
        units: of the fields, by their names in the files.
        disk: takes the failures of single ranks.
    """
    if form == "vtu":
        return VtuFields(folder, mesh.comm, pieces, units, disk)
    return HdfFields(folder, mesh, pieces, units, disk)
