"""A results folder as its report reads it: fields are read once, principal stress is added."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyvista

from castx.arrays import FloatArray
from castx.foundry.cracking import principal_values
from castx.results.files.vtu import VTK_TENSOR
from castx.results.quantities import PRINCIPAL
from castx.results.reading import Results

State = dict[str, pyvista.UnstructuredGrid]


class ReportedRun(Results):
    """Results whose fields of a time are read once, with the principal stresses that follow.

    Args:
        folder: the results folder.

    Raises:
        CaseError: it is none, or a file is missing or broken.
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._states: dict[float, State] = {}

    def grids(self, time: float | None = None) -> State:
        """Return the bodies that are there at a time, see `Results.grids`; do not change them."""
        written = self._written(time)
        if written not in self._states:
            found = super().grids(written)
            for grid in found.values():
                add_principal_stress(grid)
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
            times = [found for found in times if body in self.grids(found)] or times
        if time is None:
            return times[-1]
        return min(times, key=lambda written: abs(written - time))


def add_principal_stress(grid: pyvista.UnstructuredGrid) -> None:
    """Add the largest principal stress to the cells of a body that has the stress without it."""
    name = PRINCIPAL[0]
    if "stress" in grid.cell_data and name not in grid.cell_data:
        stress: FloatArray = np.asarray(grid.cell_data["stress"])[:, np.argsort(VTK_TENSOR)]
        grid.cell_data[name] = principal_values(stress)[:, 0]
