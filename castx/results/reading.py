"""A results folder opened for evaluation: its record, tables and fields as numpy and pyvista."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np
import pyvista

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.errors import CaseError
from castx.input.problems import among
from castx.results.files.collection import FieldSeries
from castx.results.files.run_tables import Columns, RunTables
from castx.results.files.vtu import VTK_TENSOR
from castx.results.states.snapshot import FULLY_SOLID

SAME_TIME = 1e-9
"""Difference of times, as a share of the length of the run, below which they are the same."""

NEAR = 0.25
"""Distance from the other body, in edges of a cell, below which a node lies on an interface."""


@dataclass(frozen=True)
class BodyField:
    """A field of one body at one time.

    Attributes:
        values: at the points, (points,), a vector (points, gdim); or in the cells, (cells,), the
            stress (cells, 6) in the order xx yy zz xy xz yz (axisymmetric: rr zz θθ rz 0 0).
        points: positions before anything moved, (points, gdim) [m].
        cells: points of each cell in the order of VTK, (cells, corners).
        in_cells: whether the values belong to the cells.
        time: [s].
    """

    values: FloatArray
    points: FloatArray
    cells: LongArray
    in_cells: bool
    time: float


@dataclass(frozen=True)
class InterfaceFields:
    """The nodal fields on an interface at one time.

    Attributes:
        points: the nodes of the first body that face the second one, (nodes, gdim) [m].
        values: fields there by name, (nodes,) or (nodes, gdim).
        time: [s].
    """

    points: FloatArray
    values: Columns
    time: float


@dataclass(frozen=True)
class FieldOverTime:
    """A field of a body, or on an interface, at all moments of output at which it was written.

    Attributes:
        times: of these moments, (moments,) [s].
        values: (moments, points), or with the components of a vector or tensor behind.
        points: positions before anything moved, (points, gdim) [m]; of cells their middles.
    """

    times: FloatArray
    values: FloatArray
    points: FloatArray


class Results(RunTables):
    """The results folder of a run on any number of ranks, finished or still going on.

    `RunTables` has what is not a field: record, tables, probes, hot spots, ends of stages.

    Args:
        folder: the results folder.

    Raises:
        CaseError: it is none, or a file is missing or broken.
    """

    @property
    def freezing(self) -> list[str]:
        """Names of the bodies that were not all solid at the start."""
        return [
            body
            for body in self.bodies
            if self.history.get(f"{body}.solid_fraction", np.ones(1))[0] < FULLY_SOLID
        ]

    @cached_property
    def _fields(self) -> FieldSeries:
        return FieldSeries(self.folder)

    @property
    def times(self) -> list[float]:
        """Times at which fields were written [s].

        Raises:
            CaseError: there are no fields.
        """
        return self._fields.times

    def bodies_at(self, time: float | None = None) -> list[str]:
        """Return the names of the bodies that are there at a time; their fields are not read.

        Args:
            time: one of `times` [s]; None: the last one.

        Raises:
            CaseError: no fields were written at that time.
        """
        return self._fields.bodies(self._written(time))

    def grids(self, time: float | None = None) -> dict[str, pyvista.UnstructuredGrid]:
        """Return the bodies that are there at a time with all written fields, for pyvista.

        Args:
            time: one of `times` [s]; None: the last one.

        Raises:
            CaseError: no fields were written at that time.
        """
        return self._fields.read(self._written(time))

    def field(self, name: str, body: str, time: float | None = None) -> BodyField:
        """Return a field of one body at a time as arrays.

        Args:
            name: of the field, such as "temperature".
            body: name of the body.
            time: one of `times` [s]; None: the last one.

        Raises:
            CaseError: the field was not written, or the body or the time is not there.
        """
        grid = self._grid(body, time)
        fields = [*grid.point_data, *(key for key in grid.cell_data if key != "body")]
        if name not in fields:
            raise CaseError(f"no field {name!r} was written; {among(name, fields)}")
        in_cells = name in grid.cell_data
        return BodyField(
            self._components(np.asarray(grid[name])),
            self._points(grid),
            cells_of(grid),
            in_cells,
            self._written(time),
        )

    def interface(self, name: str, time: float | None = None) -> InterfaceFields:
        """Return the nodal fields on an interface, such as gap, contact pressure and temperature.

        They are those of the first body, on its nodes that touch or face the second one. A node
        on several interfaces has the smallest of their gaps and the largest of other quantities.

        Args:
            name: of the interface, such as "casting/mould".
            time: one of `times` [s]; None: the last one.

        Raises:
            CaseError: the interface, one of its bodies or the time is not there.
        """
        if name not in self.interfaces:
            raise CaseError(f"no interface {name!r}; {among(name, self.interfaces)}")
        first, second = (self._grid(body, time) for body in name.split("/"))
        here = facing_nodes(first, second, int(self.record["interfaces"][name]["pairs"]))
        values = {
            key: self._components(np.asarray(first.point_data[key]))[here]
            for key in sorted(first.point_data)
        }
        return InterfaceFields(self._points(first)[here], Columns(values), self._written(time))

    def units(self, body: str, time: float | None = None) -> dict[str, str]:
        """Return the fields that a body has at a time, and their units.

        Raises:
            CaseError: the body or the time is not there.
        """
        from castx.results.fields import units_of  # loads the solvers

        grid = self._grid(body, time)
        return units_of([*grid.point_data, *(key for key in grid.cell_data if key != "body")])

    def unit(self, column: str) -> str:
        """Return the unit of a column of probes.csv.

        Raises:
            CaseError: there is no such column; with those that exist.
        """
        from castx.results.states.quantities import UNITS  # loads the solvers

        _ = self.probes[column]
        return "s" if column == "time" else UNITS[column.split(".")[1]]

    def over_time(self, name: str, body: str) -> FieldOverTime:
        """Return a field of one body at all moments at which the body was there.

        Raises:
            CaseError: the field was not written, or there is no such body.
        """
        if body not in self.bodies:
            raise CaseError(f"no body {body!r}; {among(body, self.bodies)}")
        there = [time for time in self.times if body in self.bodies_at(time)]
        found = [self.field(name, body, time) for time in there]
        first = found[0]
        points = first.points[first.cells].mean(axis=1) if first.in_cells else first.points
        return FieldOverTime(np.array(there), np.array([at.values for at in found]), points)

    def interface_over_time(self, interface: str, name: str) -> FieldOverTime:
        """Return a field, such as "gap", on an interface while both of its bodies were there.

        Raises:
            CaseError: the interface is not there, or the field was not written.
        """
        both = set(interface.split("/"))
        there = [time for time in self.times if both <= set(self.bodies_at(time))]
        found = [self.interface(interface, time) for time in there or self.times]
        values = np.array([at.values[name] for at in found])
        return FieldOverTime(np.array(there), values, found[0].points)

    def _written(self, time: float | None) -> float:
        """Return the time at which fields were written."""
        if time is None:
            return self.times[-1]
        nearest = min(self.times, key=lambda written: abs(written - time))
        if abs(nearest - time) > SAME_TIME * max(abs(self.times[-1]), abs(time)):
            known = ", ".join(f"{written:g}" for written in self.times)
            raise CaseError(f"no fields were written at {time:g} s; times of fields: {known} s")
        return nearest

    def _grid(self, body: str, time: float | None) -> pyvista.UnstructuredGrid:
        grids = self.grids(time)
        if body not in grids:
            when = self._written(time)
            raise CaseError(f"no body {body!r} at {when:g} s; {among(body, list(grids))}")
        return grids[body]

    def _points(self, grid: pyvista.UnstructuredGrid) -> FloatArray:
        return np.asarray(grid.points[:, : self._dimension], dtype=np.float64)

    def _components(self, values: FloatArray) -> FloatArray:
        """Return a vector or tensor with the components of the model, in the order of castx."""
        if values.ndim == 2 and values.shape[1] == 3:
            return values[:, : self._dimension]
        if values.ndim == 2 and values.shape[1] == 6:
            return values[:, np.argsort(VTK_TENSOR)]
        return values

    @property
    def _dimension(self) -> int:
        return 3 if self.model == "3d" else 2


def cells_of(grid: pyvista.UnstructuredGrid) -> LongArray:
    """Return the points of all cells, which are of one kind, (cells, corners)."""
    return np.asarray(grid.cell_connectivity, dtype=np.int64).reshape(grid.n_cells, -1)


def facing_nodes(
    first: pyvista.UnstructuredGrid, second: pyvista.UnstructuredGrid, pairs: int
) -> LongArray:
    """Return the nodes of a body that lie on another one, or are the nearest to it.

    Args:
        first: the body whose nodes are asked for.
        second: the other body.
        pairs: number of nodes to return when there is a gap between the meshes.
    """
    points = np.asarray(first.points, dtype=np.float64)
    _, closest = cast(
        tuple[LongArray, FloatArray], second.find_closest_cell(points, return_closest_point=True)
    )
    distance = np.linalg.norm(points - closest, axis=1)
    cells = cells_of(first)
    edge = np.linalg.norm(points[cells[:, 0]] - points[cells[:, 1]], axis=1).mean()
    near: BoolArray = distance < NEAR * edge
    if near.any():
        return np.flatnonzero(near)
    return np.sort(np.argsort(distance, kind="stable")[:pairs])
