"""The process that reads a field of another program and interpolates it at points.

VTK believes what a file says: a wrong index or size ends the process. So this one is run by its
path, knows nothing of castx and MPI, limits its memory, and is asked by `guarded`.

It gets the request as JSON in its argument and the points as an array (.npy) from its standard
input. It writes the arrays `values`, `distances` and `sizes` (.npz) to its standard output and ends
with 0; with the code that the request names when the output is the reason of a refusal.
"""

from __future__ import annotations

import io
import json
import os
import resource
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import reference, vtkDataArray, vtkPoints
from vtkmodules.vtkCommonDataModel import (
    vtkCellArray,
    vtkGenericCell,
    vtkStaticCellLocator,
    vtkUnstructuredGrid,
)

CORNERS = {
    3: 2, 5: 3, 8: 4, 9: 4, 10: 4, 11: 8, 12: 8, 13: 6, 14: 5,
    21: 3, 22: 6, 23: 8, 24: 10, 25: 20, 26: 15, 27: 13, 28: 9, 29: 27, 32: 18,
}  # fmt: skip
"""Points of VTK's cells, by their number in VTK."""
VTK_NUMBERS = {
    "vertex": 1, "line": 3, "triangle": 5, "quad": 9, "tetra": 10, "hexahedron": 12, "wedge": 13,
    "pyramid": 14, "line3": 21, "triangle6": 22, "quad8": 23, "tetra10": 24, "hexahedron20": 25,
    "quad9": 28, "hexahedron27": 29, "wedge18": 32,
}  # fmt: skip
"""VTK's numbers of meshio's cells."""
MESH_PARTS = (
    "NumberOfPoints", "Points", "Connectivity", "Offsets", "Types", "PointData", "Steps/Values",
    "Steps/PointOffsets", "Steps/PointDataOffsets",
)  # fmt: skip
"""Parts of a VTKHDF file that are read, beside its fields."""

Values = np.ndarray[Any, np.dtype[np.float64]]


class Refused(Exception):
    """The file cannot be used; the text says why."""

    lead = ": "


class Unreadable(Refused):
    """The file cannot be read; the text says why."""

    lead = " cannot be read: "


def main() -> None:
    """Answer the request of the command line, and end the process."""
    answer = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what libraries print must not get into the answer
    request = json.loads(sys.argv[1])
    points = np.load(io.BytesIO(sys.stdin.buffer.read()), allow_pickle=False)
    path = Path(request["path"])
    try:
        named = list(references(path)) if path.suffix.lower() == ".xdmf" else []
        sizes_of_files = [file.stat().st_size for file in {path, *(file for file, _ in named)}]
        limit_memory(request["memory"] + request["unpacked"] * sum(sizes_of_files))
        values, distances, sizes = values_at(path, request["field"], points)
        np.savez(answer, values=values, distances=distances, sizes=sizes)
        code = 0
    except Refused as error:
        answer.write(f"{error.lead}{error}".encode(errors="backslashreplace"))
        code = request["refused"]
    answer.close()
    sys.stderr.flush()
    os._exit(code)  # VTK need not tidy up what it has read


def limit_memory(more: int) -> None:
    """Let the process take only so much more memory than it has [bytes]."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmData:"):
            limit = 1024 * int(line.split()[1]) + more
            resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))


def values_at(path: Path, field: str, points: Values) -> tuple[Values, Values, Values]:
    """Return values at points, their distances from the nearest cell and its diameter."""
    grid = READERS[path.suffix.lower()](path)
    if grid.GetNumberOfCells() == 0:
        raise Refused("no cells in it")
    check_cells(grid)
    grid = of_dimension(grid, points.shape[1])
    return interpolated(grid, point_field(grid, field), placed(grid, points))


def read_vtu(path: Path) -> vtkUnstructuredGrid:
    """Return the grid of a VTU file of one piece or of several."""
    from vtkmodules.util.misc import calldata_type
    from vtkmodules.util.vtkConstants import VTK_STRING
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    faults: list[str] = []

    def note(_: Any, __: str, text: str) -> None:
        faults.append(text)

    reader = vtkXMLUnstructuredGridReader()
    reader.AddObserver("ErrorEvent", calldata_type(VTK_STRING)(note))
    reader.SetFileName(str(path))
    reader.Update()
    if faults or reader.GetErrorCode():
        raise Unreadable(f"VTK says: {faults[0] if faults else 'it is damaged'}")
    grid: vtkUnstructuredGrid = reader.GetOutput()
    return grid


def read_xdmf(path: Path) -> vtkUnstructuredGrid:
    """Return the grid and the fields of the last moment of an XDMF file."""
    for file, inside in references(path):
        check_place(file, inside)
    try:
        mesh = last_moment(path)
        blocks = [(VTK_NUMBERS[block.type], np.asarray(block.data)) for block in mesh.cells]
    except KeyError as error:
        raise Refused(f"cells of the kind {error}; known: {', '.join(VTK_NUMBERS)}") from None
    except (Exception, SystemExit) as error:  # meshio raises whatever it meets, and exits
        raise Unreadable(f"meshio says: {type(error).__name__}: {error}") from None
    points = np.zeros((len(mesh.points), 3))
    points[:, : mesh.points.shape[1]] = mesh.points
    if not blocks:
        raise Refused("no cells in it")
    widths = np.concatenate([np.full(len(rows), rows.shape[1]) for _, rows in blocks])
    kinds = np.concatenate([np.full(len(rows), kind) for kind, rows in blocks])
    grid = made(points, widths, np.concatenate([rows.ravel() for _, rows in blocks]), kinds)
    for name, array in mesh.point_data.items():
        add(grid.GetPointData(), name, array, len(points))
    for name, arrays in mesh.cell_data.items():
        add(grid.GetCellData(), name, np.concatenate(arrays), grid.GetNumberOfCells())
    return grid


def read_vtkhdf(path: Path) -> vtkUnstructuredGrid:
    """Return the grid and the point fields of the last moment of a VTKHDF file with one mesh."""
    import h5py

    try:
        for part in MESH_PARTS:
            check_place(path, f"VTKHDF/{part}")
        with h5py.File(path) as file:
            mesh, steps = file["VTKHDF"], file["VTKHDF/Steps"]
            last = min(int(steps.attrs["NSteps"]), len(steps["Values"])) - 1
            points, kinds = np.asarray(mesh["Points"], dtype=np.float64), np.asarray(mesh["Types"])
            if last < 0 or len(mesh["NumberOfPoints"]) != 1 or steps["PointOffsets"][last] != 0:
                raise Refused("no moment in it, or a mesh that changes")
            grid = made(points, np.diff(mesh["Offsets"]), mesh["Connectivity"], kinds)
            for name, data in mesh["PointData"].items():
                check_place(path, f"VTKHDF/PointData/{name}")
                check_place(path, f"VTKHDF/Steps/PointDataOffsets/{name}")
                start = int(steps["PointDataOffsets"][name][last])
                add(grid.GetPointData(), name, data[start : start + len(points)], len(points))
    except Refused:
        raise
    except Exception as error:  # h5py raises whatever it meets
        raise Unreadable(f"h5py says: {type(error).__name__}: {error}") from None
    return grid


READERS = {".vtu": read_vtu, ".xdmf": read_xdmf, ".hdf": read_vtkhdf}


def last_moment(path: Path) -> Any:
    """Return meshio's mesh at the last moment of a series, or of one mesh without a series."""
    import meshio

    try:
        with meshio.xdmf.TimeSeriesReader(path) as reader:
            points, cells = reader.read_points_cells()
            if reader.num_steps > 0:
                _, point_data, cell_data = reader.read_data(reader.num_steps - 1)
                return meshio.Mesh(points, cells, point_data=point_data, cell_data=cell_data)
    except meshio.ReadError:
        pass
    return meshio.read(path)


def references(path: Path) -> Iterator[tuple[Path, str]]:
    """Yield the files with numbers that an XDMF file names, and the places in them."""
    from xml.etree import ElementTree

    try:
        tree = ElementTree.parse(path)
    except ElementTree.ParseError as error:
        raise Unreadable(f"it is no XML: {error}") from None
    for item in tree.iter("DataItem"):
        if item.get("Format", "XML").upper() != "XML":
            name, _, inside = (item.text or "").strip().partition(":")
            file = path.parent / name
            if not name or not file.is_file():
                raise Refused(f"its numbers lie in {name or 'nothing'!r}, which is no regular file")
            yield file, inside


def check_place(file: Path, inside: str) -> None:
    """Refuse a place in an HDF5 file that leads to another file: it may be a pipe."""
    if not inside:
        return
    import h5py

    with h5py.File(file) as archive:
        found = archive
        for part in (part for part in inside.split("/") if part):
            link = found.get(part, getlink=True) if isinstance(found, h5py.Group) else None
            if not isinstance(link, h5py.HardLink):
                raise Refused(f"{file.name} holds no {inside} of its own")
            found = found[part]
        if isinstance(found, h5py.Dataset) and (found.external or found.is_virtual):
            raise Refused(f"{file.name}:{inside} lies in another file")


def made(points: Values, widths: Any, connectivity: Any, kinds: Any) -> vtkUnstructuredGrid:
    """Return a grid of points and cells, of which the numbers of points and the kinds are given."""
    offsets = np.concatenate([[0], np.cumsum(widths)]).astype(np.int64)
    grid, places, cells = vtkUnstructuredGrid(), vtkPoints(), vtkCellArray()
    places.SetData(numpy_to_vtk(points, deep=True))
    grid.SetPoints(places)
    cells.SetData(
        numpy_to_vtkIdTypeArray(offsets, deep=True),
        numpy_to_vtkIdTypeArray(np.ascontiguousarray(connectivity, dtype=np.int64), deep=True),
    )
    grid.SetCells(numpy_to_vtk(np.asarray(kinds).astype(np.uint8), deep=True), cells)
    return grid


def add(target: Any, name: str, values: Any, count: int) -> None:
    """Add an array of numbers with one row for each point or cell."""
    rows = np.asarray(values)
    if rows.dtype.kind not in "fiu" or rows.ndim not in (1, 2) or len(rows) != count:
        return
    array = numpy_to_vtk(np.ascontiguousarray(rows, dtype=np.float64), deep=True)
    array.SetName(name)
    target.AddArray(array)


def kinds_of(grid: vtkUnstructuredGrid) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """Return VTK's numbers of the kinds of all cells, by the function that its version has."""
    try:
        types = grid.GetCellTypes()
    except TypeError:  # before VTK 9.6 it asks for an argument
        types = grid.GetCellTypesArray()
    return np.asarray(vtk_to_numpy(types))


def dimension_of(kind: int) -> int:
    """Return the dimension of cells of a kind."""
    cell = vtkGenericCell()
    cell.SetCellType(kind)
    return int(cell.GetCellDimension())


def check_cells(grid: vtkUnstructuredGrid) -> None:
    """Refuse cells whose points do not exist or whose number of points does not fit their kind."""
    cells = grid.GetCells()
    connectivity = vtk_to_numpy(cells.GetConnectivityArray())
    offsets = vtk_to_numpy(cells.GetOffsetsArray())
    kinds = kinds_of(grid)
    widths = np.diff(offsets)
    wrong = offsets[0] != 0 or offsets[-1] != len(connectivity) or (widths < 0).any()
    if wrong or len(kinds) != len(widths):
        raise Refused("the offsets of its cells do not fit their points")
    points = grid.GetNumberOfPoints()
    outside = connectivity[(connectivity < 0) | (connectivity >= points)]
    if outside.size:
        raise Refused(f"a cell has point {outside[0]}, and the points are 0 to {points - 1}")
    for kind in np.unique(kinds):
        width = CORNERS.get(int(kind))
        here = widths[kinds == kind]
        if width is not None and (here != width).any():
            wrong_width = here[here != width][0]
            raise Refused(f"a cell of kind {kind} has {wrong_width} points instead of {width}")
    if not np.isfinite(vtk_to_numpy(grid.GetPoints().GetData())).all():
        raise Refused("it has points whose coordinates are no finite numbers")


def of_dimension(grid: vtkUnstructuredGrid, dimension: int) -> vtkUnstructuredGrid:
    """Return the part of a grid that has the dimension of the model."""
    types = kinds_of(grid)
    kinds = np.unique(types)
    fitting = [kind for kind in kinds if dimension_of(int(kind)) == dimension]
    if not fitting:
        shape = {2: "triangles or quadrilaterals", 3: "tetrahedra, hexahedra, wedges or pyramids"}
        raise Refused(f"the model needs cells that are {shape[dimension]}")
    if len(fitting) == len(kinds):
        return grid
    chosen = np.flatnonzero(np.isin(types, fitting))
    offsets = vtk_to_numpy(grid.GetCells().GetOffsetsArray())
    connectivity = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    rows = [connectivity[offsets[k] : offsets[k + 1]] for k in chosen]
    used, corners = np.unique(np.concatenate(rows), return_inverse=True)
    widths = np.array([len(row) for row in rows])
    points = np.asarray(vtk_to_numpy(grid.GetPoints().GetData())[used], dtype=np.float64)
    part = made(points, widths, corners, types[chosen])
    for source, target, places in (
        (grid.GetPointData(), part.GetPointData(), used),
        (grid.GetCellData(), part.GetCellData(), chosen),
    ):
        for name in names_of(source):
            array = source.GetAbstractArray(name)
            if isinstance(array, vtkDataArray) and array.GetNumberOfTuples() > places.max():
                add(target, name, vtk_to_numpy(array)[places], len(places))
    return part


def point_field(grid: vtkUnstructuredGrid, name: str) -> Values:
    """Return the field at the points of the grid, averaged where it is given in the cells."""
    from vtkmodules.vtkFiltersCore import vtkCellDataToPointData

    known = [*names_of(grid.GetPointData()), *names_of(grid.GetCellData())]
    if name not in known:
        raise Refused(json.dumps({"field": name, "known": known}))
    if name not in names_of(grid.GetPointData()):
        averaging = vtkCellDataToPointData()
        averaging.SetInputData(grid)
        averaging.Update()
        grid = averaging.GetOutput()
    array = grid.GetPointData().GetAbstractArray(name)
    if not isinstance(array, vtkDataArray):
        raise Refused(f"the field {name!r} holds no numbers")
    values = np.asarray(vtk_to_numpy(array), dtype=np.float64)
    if values.ndim == 2 and values.shape[1] == 1:
        values = values[:, 0]
    if values.ndim != 1:
        raise Refused(f"the field {name!r} is no scalar, it has {values.shape[1]} parts")
    if len(values) != grid.GetNumberOfPoints():
        raise Refused(f"the field {name!r} has {len(values)} values for its points")
    if not np.isfinite(values).all():
        raise Refused(f"the field {name!r} holds numbers that are not finite")
    return values


def names_of(data: Any) -> list[str]:
    """Return the names of the arrays of points or cells."""
    arrays = (data.GetAbstractArray(index) for index in range(data.GetNumberOfArrays()))
    return [str(array.GetName()) for array in arrays]


def placed(grid: vtkUnstructuredGrid, points: Values) -> Values:
    """Return points (n, 3) where the grid has them: a plane one may lie in any coordinate plane."""
    places = np.zeros((len(points), 3))
    if points.shape[1] == 3:
        places[:] = points
        return places
    there = vtk_to_numpy(grid.GetPoints().GetData())
    flat = int(np.argmin(np.ptp(there, axis=0)))
    places[:, flat] = there[:, flat].mean()
    places[:, [axis for axis in range(3) if axis != flat]] = points
    return places


def interpolated(
    grid: vtkUnstructuredGrid, field: Values, points: Values
) -> tuple[Values, Values, Values]:
    """Return the field at points, their distances from the nearest cell, and its diameter."""
    locator = vtkStaticCellLocator()
    locator.SetDataSet(grid)
    locator.BuildLocator()
    cell = vtkGenericCell()
    number_of, part, squared = reference(0), reference(0), reference(0.0)
    foot, local = [0.0] * 3, [0.0] * 3
    result = np.empty((3, len(points)))
    for k, point in enumerate(points):
        locator.FindClosestPoint(point, foot, cell, number_of, part, squared)
        result[1, k] = float(squared) ** 0.5
        result[2, k] = cell.GetLength2() ** 0.5
        weights = [0.0] * cell.GetNumberOfPoints()
        cell.EvaluatePosition(foot, [0.0] * 3, part, local, squared, weights)
        corners = [cell.GetPointId(i) for i in range(len(weights))]
        result[0, k] = np.dot(weights, field[corners])
    return result[0], result[1], result[2]


if __name__ == "__main__":
    main()
