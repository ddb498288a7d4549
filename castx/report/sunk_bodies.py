"""Pipes of the bodies of a run at the moments of a view, and the cells through which they pass.

A view cuts a body at the moment that it shows where the field `emptied` passes a level
(`castx.results.sunk_shape`), so that one mesh serves all moments. Of a large body it has the outer
faces alone, and the cells beside its pipes, whose sections are the walls of these.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pyvista
from vtkmodules.vtkFiltersCore import vtkAppendFilter

from castx.arrays import LongArray
from castx.case.fields.feeding import EMPTIED
from castx.report.pictures import outer_faces
from castx.results.reading import cells_of
from castx.results.sunk_shape import pipe_level, simplices

State = Mapping[str, pyvista.UnstructuredGrid]


@dataclass(frozen=True)
class Pipes:
    """Pipes of the bodies of a run.

    Attributes:
        levels: share of a node that has flowed out beyond which a body is cut at each moment, by
            its name; None: it is whole then. Bodies that are always whole are left out.
        cells: through which the pipes of a body pass at any moment, ascending, by its name.
    """

    levels: dict[str, list[float | None]]
    cells: dict[str, LongArray]

    @classmethod
    def of(cls, model: str, states: Sequence[State]) -> Pipes:
        """Return the pipes of all bodies.

        Args:
            model: of the run.
            states: the bodies at the moments.
        """
        levels: dict[str, list[float | None]] = {}
        cells: dict[str, LongArray] = {}
        for name in {name: None for state in states for name in state}:
            grids = [state.get(name) for state in states]
            own = [None if grid is None else pipe_level(grid, model) for grid in grids]
            passed = [
                passing(grid, level)
                for grid, level in zip(grids, own, strict=True)
                if grid is not None and level is not None
            ]
            if passed:
                levels[name], cells[name] = own, np.unique(np.concatenate(passed))
        return cls(levels, cells)


def passing(grid: pyvista.UnstructuredGrid, level: float) -> LongArray:
    """Return the cells of a body through which its pipe passes at a level."""
    emptied = np.asarray(grid[EMPTIED])[cells_of(grid)]
    through = (emptied.min(axis=1) <= level) & (emptied.max(axis=1) > level)
    return np.asarray(np.flatnonzero(through), dtype=np.int64)


def surface_of(grid: pyvista.UnstructuredGrid, cells: LongArray) -> pyvista.UnstructuredGrid:
    """Return the outer faces of a body as triangles, and behind them some cells as tetrahedra.

    Args:
        grid: the body, in space.
        cells: numbers of these cells, (n,).
    """
    faces = outer_faces(grid).triangulate().cast_to_unstructured_grid()
    if not len(cells):
        return faces
    both = vtkAppendFilter()
    both.AddInputData(faces)
    both.AddInputData(simplices(grid.extract_cells(cells)))
    both.Update()
    return pyvista.UnstructuredGrid(both.GetOutput())
