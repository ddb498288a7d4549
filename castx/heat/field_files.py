"""Temperatures from files of other programs, interpolated at given points; on one rank."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from castx.arrays import FloatArray
from castx.case.initial_temperature import FieldFile
from castx.errors import CaseError
from castx.input.problems import among
from castx.input.units import TEMPERATURE, number

if TYPE_CHECKING:
    import pyvista

LARGEST_FILE = 4 * 1024**3
"""Bytes of a file that is still read."""


@dataclass(frozen=True)
class Interpolated:
    """Values at points, and how far from the cells of the file they were taken.

    Args:
        values: shape (points,).
        distances: of the points from the nearest cell, zero inside [m].
        sizes: diameter of that cell [m].
    """

    values: FloatArray
    distances: FloatArray
    sizes: FloatArray


def temperatures_at(file: FieldFile, points: FloatArray) -> FloatArray:
    """Return the temperatures of a file at points [°C].

    They are interpolated in the cell that contains the point, as VTK does for its kind: linearly in
    simplices. A point outside by less than the size of the nearest cell takes the temperature of
    the nearest point of that cell. Plane models read the plane in which the file lies.

    Args:
        file: the file and its field.
        points: shape (points, gdim) [m].

    Raises:
        CaseError: the file cannot be read, lacks the field or its cells, has no temperatures, or
            a point lies farther out.
    """
    grid = _cells(_read(file), points.shape[1], file)
    field = _point_field(grid, file)
    found = _interpolate(grid, field, _placed(grid, points))
    outside = found.distances > found.sizes
    if outside.any():
        k = int(np.argmax(found.distances - found.sizes))
        place = ", ".join(f"{value:g}" for value in points[k])
        raise CaseError(
            f"{file.path}: its mesh ends {found.distances[k]:.3g} m short of ({place}) m, more "
            f"than the size of a cell; {np.count_nonzero(outside)} of {len(points)} nodes lie so "
            "far out (is the file in m?)"
        )
    return _in_degrees(found.values, file)


def _read(file: FieldFile) -> pyvista.UnstructuredGrid:
    import pyvista

    path = file.path
    if not path.is_file():
        raise CaseError(f"there is no file {path}")
    if path.stat().st_size > LARGEST_FILE:
        raise CaseError(f"{path}: larger than {LARGEST_FILE / 1024**3:g} GiB")
    try:
        if path.suffix.lower() == ".vtu":
            grid = pyvista.read(path)
        else:
            grid = pyvista.wrap(_read_xdmf(path))
    except Exception as error:  # readers of foreign files raise whatever they meet
        raise CaseError(f"{path} cannot be read: {type(error).__name__}: {error}") from error
    if grid is None or grid.n_cells == 0:
        raise CaseError(f"{path}: no cells in it")
    return grid


def _read_xdmf(path: Any) -> Any:
    """Return the mesh and the fields of the last moment."""
    import meshio

    try:
        with meshio.xdmf.TimeSeriesReader(path) as reader:
            points, cells = reader.read_points_cells()
            if reader.num_steps > 0:
                _, point_data, cell_data = reader.read_data(reader.num_steps - 1)
                return meshio.Mesh(points, cells, point_data=point_data, cell_data=cell_data)
    except meshio.ReadError:
        pass  # one mesh without a series
    return meshio.read(path)


def _cells(
    grid: pyvista.UnstructuredGrid, dimension: int, file: FieldFile
) -> pyvista.UnstructuredGrid:
    """Return the part of a grid that has the dimension of the model."""
    from vtkmodules.vtkCommonDataModel import vtkCellTypes

    kinds = np.unique(grid.celltypes)
    fitting = [k for k in kinds if vtkCellTypes.GetDimension(int(k)) == dimension]
    if not fitting:
        shape = {2: "triangles or quadrilaterals", 3: "tetrahedra, hexahedra, wedges or pyramids"}
        raise CaseError(f"{file.path}: the model needs cells that are {shape[dimension]}")
    if len(fitting) < len(kinds):
        grid = grid.extract_cells(np.flatnonzero(np.isin(grid.celltypes, fitting)))
    return grid


def _point_field(grid: pyvista.UnstructuredGrid, file: FieldFile) -> FloatArray:
    """Return the field at the points of the grid, averaged where it is given in the cells."""
    name = file.field
    if name not in grid.point_data and name in grid.cell_data:
        grid = grid.cell_data_to_point_data()
    if name not in grid.point_data:
        known = [*grid.point_data.keys(), *grid.cell_data.keys()]
        raise CaseError(f"{file.path}: no field {name!r}; {among(name, known, what='it has')}")
    values = np.asarray(grid.point_data[name], dtype=np.float64)
    if values.ndim == 2 and values.shape[1] == 1:
        values = values[:, 0]
    if values.ndim != 1:
        parts = values.shape[1]
        raise CaseError(f"{file.path}: the field {name!r} is no scalar, it has {parts} parts")
    if not np.isfinite(values).all():
        raise CaseError(f"{file.path}: the field {name!r} holds numbers that are not finite")
    return values


def _placed(grid: pyvista.UnstructuredGrid, points: FloatArray) -> FloatArray:
    """Return points (n, 3) where the grid has them: a plane one may lie in any coordinate plane."""
    places = np.zeros((len(points), 3))
    if points.shape[1] == 3:
        places[:] = points
        return places
    extent = np.ptp(grid.points, axis=0)
    flat = int(np.argmin(extent))
    places[:, flat] = grid.points[:, flat].mean()
    places[:, [axis for axis in range(3) if axis != flat]] = points
    return places


def _interpolate(
    grid: pyvista.UnstructuredGrid, field: FloatArray, points: FloatArray
) -> Interpolated:
    from vtkmodules.vtkCommonCore import reference
    from vtkmodules.vtkCommonDataModel import vtkGenericCell, vtkStaticCellLocator

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
    return Interpolated(*result)


def _in_degrees(values: FloatArray, file: FieldFile) -> FloatArray:
    zero, thousand = (number(f"{value} {file.unit}", TEMPERATURE) for value in (0, 1000))
    celsius = zero + (thousand - zero) / 1000.0 * values
    try:
        number(float(celsius.min()), TEMPERATURE)
    except CaseError as error:
        raise CaseError(f"{file.path}: the field {file.field!r} goes {error}") from None
    return np.asarray(celsius)
