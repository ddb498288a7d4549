"""The part of a body that lies on this rank as a VTK file."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from castx.arrays import FloatArray, IntArray, LongArray

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkDataSetAttributes

    from castx.domain.mesh import BodyMesh

VTK_TENSOR = [0, 1, 2, 3, 5, 4]
"""From xx yy zz xy xz yz to VTK's order of a symmetric tensor, xx yy zz xy yz xz."""

OWN_ERRORS = 20000
"""Codes of VTK's own errors begin here, below are those of the system."""


@dataclass(frozen=True)
class Piece:
    """The cells of a body that this rank owns, with the nodes they need.

    Args:
        cells: number of cells.
        nodes: local node behind each point of the piece, (points,).
        points: positions, (points, 3).
        connectivity: points of all cells one after the other, as VTK orders them.
        kind: VTK's number of the cell type.
    """

    cells: int
    nodes: LongArray
    points: FloatArray
    connectivity: LongArray
    kind: int

    @classmethod
    def of(cls, body: BodyMesh) -> Piece:
        """Return the piece of a body."""
        from dolfinx.plot import vtk_mesh  # files are read without it

        topology = body.nodes.mesh.topology
        owned = np.arange(topology.index_map(topology.dim).size_local, dtype=np.int32)
        if owned.size == 0:
            none = np.empty(0, dtype=np.int64)
            return cls(0, none, np.empty((0, 3)), none, 0)
        rows, kinds, _ = vtk_mesh(body.nodes, entities=owned)
        corners = rows.reshape(owned.size, -1)[:, 1:]
        nodes, connectivity = np.unique(corners, return_inverse=True)
        # Interpolated coordinates differ by round-off between ranks: readers could not join pieces.
        points = np.zeros((nodes.size, 3))
        points[:, : body.mesh.geometry.dim] = body.points[nodes]
        return cls(
            cells=owned.size,
            nodes=nodes.astype(np.int64),
            points=points,
            connectivity=connectivity.ravel().astype(np.int64),
            kind=int(kinds[0]),
        )


def write_piece(
    path: Path,
    piece: Piece,
    number: int,
    nodal: Mapping[str, FloatArray],
    cellwise: Mapping[str, FloatArray],
    name: str = "",
    units: Mapping[str, str] | None = None,
) -> None:
    """Write a piece as VTU: binary, appended, compressed.

    Args:
        path: the file.
        piece: the mesh.
        number: of the body; a cell array `body` holds it, so that bodies can be told apart.
        nodal: fields at the points, (points,) or (points, gdim); vectors get three components.
        cellwise: fields of the cells, (cells,), a symmetric tensor (cells, 6) as in `Snapshot`.
        name: of the body; the field data `name` hold it.
        units: of the fields by name, written into their arrays as VTK's UNITS_LABEL.
    """
    # Few runs write this format, and VTK takes long to import.
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkUnstructuredGrid
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    grid = vtkUnstructuredGrid()
    points = vtkPoints()
    points.SetData(numpy_to_vtk(piece.points, deep=True))
    grid.SetPoints(points)
    size = piece.connectivity.size // piece.cells
    offsets = np.arange(0, piece.connectivity.size + 1, size, dtype=np.int64)
    cells = vtkCellArray()
    cells.SetData(
        numpy_to_vtkIdTypeArray(offsets, deep=True),
        numpy_to_vtkIdTypeArray(piece.connectivity, deep=True),
    )
    grid.SetCells(piece.kind, cells)
    add_arrays(grid.GetPointData(), nodal, units or {})
    add_arrays(grid.GetCellData(), cellwise, units or {})
    if name:
        text = vtkStringArray()
        text.SetName("name")
        text.InsertNextValue(name)
        grid.GetFieldData().AddArray(text)
    bodies = np.full(piece.cells, number, dtype=np.int32)
    add_arrays(grid.GetCellData(), {"body": bodies}, {})
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToZLib()
    written, code = writer.Write(), writer.GetErrorCode()
    if 0 < code < OWN_ERRORS:
        raise OSError(code, os.strerror(code), str(path))
    if written != 1 or code != 0 or not path.exists():  # VTK returns 1 where it finds no folder
        raise OSError(f"cannot write {path}")


def add_arrays(
    target: vtkDataSetAttributes,
    arrays: Mapping[str, FloatArray | IntArray],
    units: Mapping[str, str],
) -> None:
    """Add named arrays, with the units known, to the point or cell data of a grid."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkDataArray

    for name, values in arrays.items():
        array = numpy_to_vtk(vtk_columns(values), deep=True)
        array.SetName(name)
        if name in units:
            array.GetInformation().Set(vtkDataArray.UNITS_LABEL(), units[name])
        target.AddArray(array)


def vtk_columns(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return a field as VTK has it: three parts of a vector, its order of a symmetric tensor.

    Args:
        values: (rows,), (rows, gdim), or (rows, 6) as in `Snapshot`.
    """
    columns = values
    if values.ndim == 2 and values.shape[1] == 2:
        columns = np.column_stack([values, np.zeros(len(values))])
    if values.ndim == 2 and values.shape[1] == 6:
        columns = values[:, VTK_TENSOR]
    return np.ascontiguousarray(columns)
