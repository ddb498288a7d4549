"""A results folder as its report reads it: fields are read once, and made fit to be seen."""

from __future__ import annotations

import logging
from pathlib import Path

import numpy as np
import pyvista

from castx.arrays import FloatArray
from castx.foundry.cracking import principal_values
from castx.results.files.vtu import VTK_TENSOR
from castx.results.reading import Results, cells_of
from castx.results.states.quantities import PRINCIPAL

log = logging.getLogger(__name__)
State = dict[str, pyvista.UnstructuredGrid]
ON_SURFACES = ("deviation", "first_opening")
"""Fields of nodes that are not a number inside."""
FLAT = (pyvista.CellType.TRIANGLE, pyvista.CellType.QUAD)


class ReportedRun(Results):
    """Results whose fields of a time are read once, as pictures show them.

    The principal stress that follows from a stress is there, of the heat flux its size, of the life
    of a die its decimal logarithm, and in plane models what stands on surfaces is one cell wide.

    Args:
        folder: the results folder.

    Raises:
        CaseError: it is none, or a file is missing or broken.
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        for doubt in self.doubts:
            log.warning(doubt)
        self._states: dict[float, State] = {}

    def grids(self, time: float | None = None) -> State:
        """Return the bodies that are there at a time, see `Results.grids`; do not change them."""
        written = self._written(time)
        if written not in self._states:
            found = super().grids(written)
            for grid in found.values():
                add_principal_stress(grid)
                take_sizes(grid)
                widen_surfaces(grid)
            self._states[written] = found
        return self._states[written]

    def nearest(self, time: float | None, body: str | None = None) -> float:
        """Return the time of fields that is nearest to a time; None: the last one.

        Args:
            time: [s].
            body: that has to be there then, unless it never is.
        """
        times = self.times
        if body is not None:
            times = [found for found in times if body in self.bodies_at(found)] or times
        if time is None:
            return times[-1]
        return min(times, key=lambda written: abs(written - time))


def add_principal_stress(grid: pyvista.UnstructuredGrid) -> None:
    """Add the largest principal stress to the cells of a body that has the stress without it."""
    name = PRINCIPAL[0]
    if "stress" in grid.cell_data and name not in grid.cell_data:
        stress: FloatArray = np.asarray(grid.cell_data["stress"])[:, np.argsort(VTK_TENSOR)]
        grid.cell_data[name] = principal_values(stress)[:, 0]


def take_sizes(grid: pyvista.UnstructuredGrid) -> None:
    """Put the size of the heat flux and the decimal logarithm of the life in their places."""
    if "heat_flux" in grid.cell_data:
        grid.cell_data["heat_flux"] = np.linalg.norm(grid.cell_data["heat_flux"], axis=1)
    if "life" in grid.cell_data:
        life = np.asarray(grid.cell_data["life"], dtype=np.float64)
        known = np.isfinite(life) & (life > 0.0)
        grid.cell_data["life"] = np.log10(life, out=np.full(len(life), np.nan), where=known)


def widen_surfaces(grid: pyvista.UnstructuredGrid) -> None:
    """Give the nodes next to a surface the mean of what stands there: a line would not be seen."""
    if not np.isin(grid.celltypes[:1], FLAT).any():
        return
    cells = cells_of(grid)
    for name in set(ON_SURFACES) & set(grid.point_data):
        values = np.asarray(grid.point_data[name], dtype=np.float64)
        known = np.isfinite(values)
        total, count = np.zeros(len(values)), np.zeros(len(values))
        seen = known[cells]
        np.add.at(total, cells, np.where(seen, values[cells], 0.0).sum(axis=1)[:, None])
        np.add.at(count, cells, seen.sum(axis=1)[:, None])
        beside = ~known & (count > 0.0)
        values = values.copy()
        values[beside] = total[beside] / count[beside]
        grid.point_data[name] = values
