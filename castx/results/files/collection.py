"""Written fields read back: the files of bodies, or the pieces behind castx.pvd."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol
from xml.etree import ElementTree

import pyvista
from vtkmodules.vtkCommonCore import vtkObject
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

from castx.errors import CaseError
from castx.results.files.body_series import BodySeries
from castx.results.files.folder import COLLECTION, ENDING, FIELDS, reason_of


class WrittenFields(Protocol):
    """Fields on disk in one of the formats.

    Attributes:
        times: at which fields were written [s].
    """

    times: list[float]

    def bodies(self, time: float, /) -> list[str]:
        """Return the names of the bodies at one of the times."""

    def read(self, time: float, /) -> dict[str, pyvista.UnstructuredGrid]:
        """Return the bodies at one of the times."""


class FieldSeries:
    """The written fields of a run, in either format.

    Attributes:
        times: at which fields were written [s].

    Args:
        folder: the results folder.

    Raises:
        CaseError: there are no fields, or they are damaged.
    """

    def __init__(self, folder: Path) -> None:
        fields = folder / FIELDS
        try:
            pieces = (fields / COLLECTION).is_file()
        except OSError as error:
            raise CaseError(f"{fields} cannot be read: {reason_of(error)}") from None
        self._written: WrittenFields = PieceSeries(fields) if pieces else BodySeries(fields)
        self.times = self._written.times
        if not self.times:
            raise CaseError(
                f"there are no fields in {folder}: neither {fields / f'BODY{ENDING}'} nor "
                f"{fields / COLLECTION}"
            )

    def bodies(self, time: float) -> list[str]:
        """Return the names of the bodies at one of the times, without reading their fields."""
        return self._written.bodies(time)

    def read(self, time: float) -> dict[str, pyvista.UnstructuredGrid]:
        """Return the bodies at one of the times.

        Raises:
            CaseError: a file is missing or damaged.
        """
        return self._written.read(time)


class PieceSeries:
    """The pieces behind castx.pvd.

    Attributes:
        times: at which fields were written [s].

    Args:
        folder: of the collection.

    Raises:
        CaseError: it is damaged.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        collection = folder / COLLECTION
        self._pieces: dict[float, list[tuple[str, str]]] = {}
        try:
            for entry in ElementTree.parse(collection).iter("DataSet"):
                time, body, file = (entry.attrib[key] for key in ("timestep", "group", "file"))
                self._add(float(time), body, file)
        except (ElementTree.ParseError, KeyError, ValueError) as error:
            raise CaseError(f"{collection} is damaged: {error}") from None
        if not self._pieces:
            raise CaseError(f"{collection} is damaged: it names no fields")
        self.times: list[float] = sorted(self._pieces)

    def _add(self, time: float, body: str, file: str) -> None:
        pieces = self._pieces.setdefault(time, [])
        if Path(file).name != file:
            raise ValueError(f"{file} is not the name of a file beside it")
        if (body, file) in pieces:
            raise ValueError(f"{file} is there twice")
        pieces.append((body, file))

    def bodies(self, time: float) -> list[str]:
        """Return the names of the bodies at one of the times."""
        return list(dict.fromkeys(body for body, _ in self._pieces[time]))

    def read(self, time: float) -> dict[str, pyvista.UnstructuredGrid]:
        """Return the bodies at one of the times, the pieces of all ranks put together.

        Raises:
            CaseError: a file is missing or damaged.
        """
        pieces: dict[str, list[pyvista.UnstructuredGrid]] = {}
        for body, file in self._pieces[time]:
            pieces.setdefault(body, []).append(read_piece(self._folder / file))
        return {name: pyvista.merge(parts) for name, parts in pieces.items()}


def read_piece(path: Path) -> pyvista.UnstructuredGrid:
    """Return the mesh of a VTU file with its fields.

    Raises:
        CaseError: it is missing or damaged.
    """
    if not path.is_file():  # VTK would wait for what is written into a pipe
        raise CaseError(f"{path} is missing or damaged: it is no regular file")
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    shown = vtkObject.GetGlobalWarningDisplay()
    vtkObject.SetGlobalWarningDisplay(0)  # VTK would print what the refusal says
    try:
        reader.Update()
    finally:
        vtkObject.SetGlobalWarningDisplay(shown)
    if reader.GetErrorCode() != 0:
        raise CaseError(f"{path} is missing or damaged: no mesh can be read from it")
    grid = reader.GetOutput()
    data = [grid.GetPointData(), grid.GetCellData()]
    counts = [grid.GetNumberOfPoints(), grid.GetNumberOfCells()]
    for fields, count in zip(data, counts, strict=True):
        arrays = [fields.GetArray(number) for number in range(fields.GetNumberOfArrays())]
        if any(array is None or array.GetNumberOfTuples() != count for array in arrays):
            raise CaseError(f"{path} is damaged: its fields do not belong to its mesh")
    if 0 in counts:
        raise CaseError(f"{path} is missing or damaged: no mesh can be read from it")
    return pyvista.wrap(grid)
