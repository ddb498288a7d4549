"""Written fields read back: the pieces of all bodies, ranks and times behind castx.pvd."""

from __future__ import annotations

from pathlib import Path

import pyvista

from castx.errors import CaseError
from castx.results.files.folder import COLLECTION, FIELDS


class FieldSeries:
    """The written fields of a run, read from fields/castx.pvd.

    Attributes:
        times: at which fields were written [s].

    Args:
        folder: the results folder.

    Raises:
        CaseError: there are no fields.
    """

    def __init__(self, folder: Path) -> None:
        collection = folder / FIELDS / COLLECTION
        if not collection.is_file():
            raise CaseError(f"there are no fields in {folder}: {collection} is missing")
        self._reader = pyvista.get_reader(collection)
        self.times: list[float] = [float(time) for time in self._reader.time_values]

    def read(self, time: float) -> dict[str, pyvista.UnstructuredGrid]:
        """Return the bodies at one of the times, the pieces of all ranks put together."""
        self._reader.set_active_time_value(time)
        blocks = self._reader.read()
        pieces: dict[str, list[pyvista.DataSet]] = {}
        for dataset, block in zip(self._reader.active_datasets, blocks, strict=True):
            pieces.setdefault(dataset.group, []).append(block)
        return {name: pyvista.merge(parts) for name, parts in pieces.items()}
