"""Fields read back from the VTKHDF files of the bodies of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import numpy.typing as npt
import pyvista

from castx.arrays import FloatArray, LongArray
from castx.errors import CaseError
from castx.results.files.folder import ENDING
from castx.results.files.grown_file import ABSENT, opened
from castx.results.files.vtkhdf import ROOT, STEPS, TIMES, counted_steps

_DAMAGES = (AttributeError, IndexError, KeyError, OSError, OverflowError, TypeError, ValueError)


class BodySeries:
    """The files of all bodies in a folder.

    Attributes:
        times: at which fields were written [s].

    Args:
        folder: of the files.

    Raises:
        CaseError: a file is damaged.
    """

    def __init__(self, folder: Path) -> None:
        bodies = [SavedBody(path) for path in sorted(folder.glob(f"[!.]*{ENDING}"))]
        self._bodies = sorted(bodies, key=lambda body: body.number)
        self.times: list[float] = sorted({float(time) for body in bodies for time in body.times})

    def bodies(self, time: float) -> list[str]:
        """Return the names of the bodies at one of the times, without their fields."""
        return [body.name for body in self._bodies if time in body.times]

    def read(self, time: float) -> dict[str, pyvista.UnstructuredGrid]:
        """Return the bodies at one of the times.

        Raises:
            CaseError: a file is damaged.
        """
        return {body.name: body.grid(time) for body in self._bodies if time in body.times}


class SavedBody:
    """A body in its file.

    Attributes:
        name: of the body.
        number: of the body.
        times: at which its fields were written [s].

    Args:
        path: of the file.

    Raises:
        CaseError: the file is damaged.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            with opened(path, "r") as file:
                root = file[ROOT]
                self.name, self.number = str(root.attrs["name"]), int(root.attrs["number"])
                self.times: FloatArray = root[STEPS][TIMES][: counted_steps(root[STEPS])]
                self._points = np.asarray(root["Points"], dtype=np.float64)
                self._cells = cells_of(root, len(self._points))
                self._kind = pyvista.CellType(int(root["Types"][0]))
            self._refuse_another_body()
        except _DAMAGES as error:
            raise _damaged(path, error) from None

    def _refuse_another_body(self) -> None:
        if self.name != self._path.stem:
            raise ValueError(f"it holds fields of {self.name!r}, not of {self._path.stem!r}")
        if not np.all(np.diff(self.times) > 0.0):
            raise ValueError("its times do not ascend")

    def grid(self, time: float) -> pyvista.UnstructuredGrid:
        """Return the body with its fields at one of its times.

        Raises:
            CaseError: the file is damaged.
        """
        step = int(np.searchsorted(self.times, time))
        try:
            grid = pyvista.UnstructuredGrid({self._kind: self._cells}, self._points)
            with opened(self._path, "r") as file:
                root = file[ROOT]
                grid.point_data.update(fields_of(root, "Point", step, len(self._points)))
                grid.cell_data.update(fields_of(root, "Cell", step, len(self._cells)))
        except _DAMAGES as error:
            raise _damaged(self._path, error) from None
        return grid


def cells_of(root: h5py.Group, points: int) -> LongArray:
    """Return the points of all cells, which are of one kind, (cells, corners).

    Args:
        root: of the file.
        points: their number.

    Raises:
        ValueError: they do not belong to the points.
    """
    cells = np.asarray(root["Connectivity"], dtype=np.int64).reshape(len(root["Types"]), -1)
    if cells.size == 0 or cells.min() < 0 or cells.max() >= points:
        raise ValueError("its cells do not belong to its points")
    return cells


def fields_of(root: h5py.Group, kind: str, step: int, rows: int) -> dict[str, npt.NDArray[Any]]:
    """Return the fields of a step by name, without those that it lacks.

    Args:
        root: of the file.
        kind: "Point" or "Cell".
        step: number of the step.
        rows: number of points or cells.

    Raises:
        ValueError: fields do not belong to the mesh.
    """
    found = {}
    for name, data in root[f"{kind}Data"].items():
        start = int(root[STEPS][f"{kind}DataOffsets"][name][step])
        if start == data.attrs.get(ABSENT):
            continue
        found[name] = np.asarray(data[start : start + rows])
        if len(found[name]) != rows:
            raise ValueError("its fields do not belong to its mesh")
    return found


def _damaged(path: Path, error: Exception) -> CaseError:
    return CaseError(f"{path} is missing or damaged: {error}")
