"""One body at one moment of a run, as it is handed over: its mesh and the fields that it needs."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.case.case import Case
from castx.case.output import Output
from castx.case.reading.read import load_case
from castx.errors import CaseError
from castx.foundry.followed.foundry_fields import entry_of
from castx.input.problems import among
from castx.results.files.folder import CASE
from castx.results.reading import Results, cells_of

if TYPE_CHECKING:
    import pyvista


@dataclass(frozen=True, eq=False)
class BodyState:
    """One body at one moment of a run.

    Args:
        results: of the run.
        name: of the body.
        time: at which fields were written [s]; None: the last one.

    Raises:
        CaseError: there is no such body then, or no field of that time.
    """

    results: Results
    name: str
    time: float | None = None

    def __post_init__(self) -> None:
        if self.name not in self.results.bodies:
            raise CaseError(f"no body {self.name!r}; {among(self.name, self.results.bodies)}")
        if self.grid.n_cells == 0:
            raise CaseError(f"the body {self.name!r} has no cells")

    @classmethod
    def chosen(
        cls,
        results: Results,
        body: str | None = None,
        time: float | None = None,
        stage: int | None = None,
    ) -> BodyState:
        """Return the body and moment that a user chooses.

        Args:
            results: of the run.
            body: its name; None: the only one that freezes.
            time: at which fields were written [s]; None: the last one, unless a stage is given.
            stage: number of the stage at whose end it is, from 0.

        Raises:
            CaseError: there is no such body, moment or stage, or more than one body freezes.
        """
        if body is None:
            found = results.freezing or list(results.bodies)
            if len(found) != 1:
                raise CaseError(f"choose a body: --body NAME; there are {', '.join(found)}")
            body = found[0]
        if stage is None:
            return cls(results, body, time)
        if time is not None:
            raise CaseError("a time and the end of a stage are two moments; leave one out")
        return cls(results, body, results.stage_end(stage)["time"])

    @cached_property
    def grid(self) -> pyvista.UnstructuredGrid:
        """Mesh and fields, for pyvista."""
        grids = self.results.grids(self.time)
        if self.name not in grids:
            known = among(self.name, list(grids))
            raise CaseError(f"no body {self.name!r} at {self.moment:g} s; {known}")
        return grids[self.name]

    @property
    def moment(self) -> float:
        """The time of the fields [s]."""
        return self.results.times[-1] if self.time is None else self.time

    @property
    def model(self) -> str:
        """Geometric model."""
        return self.results.model

    @property
    def points(self) -> FloatArray:
        """Positions of the nodes before anything moved, (nodes, 3) [m]."""
        return np.asarray(self.grid.points, dtype=np.float64)

    @property
    def cells(self) -> LongArray:
        """Nodes of the cells in the order of VTK, (cells, corners)."""
        return cells_of(self.grid)

    @property
    def about(self) -> dict[str, Any]:
        """Entry of the body in run.json."""
        return dict(self.results.record["bodies"][self.name])

    @property
    def planes(self) -> list[tuple[FloatArray, float]]:
        """Planes of symmetry: normals (3,) and distances from the origin along them [m]."""
        found: list[tuple[FloatArray, float]] = []
        for plane in self.about.get("symmetry", []):
            normal: FloatArray = np.zeros(3)
            normal[: len(plane["normal"])] = plane["normal"]
            found.append((normal, float(plane["offset"])))
        return found

    @cached_property
    def case(self) -> Case:
        """The case as it was run.

        Raises:
            CaseError: its copy in the results folder is missing or broken.
        """
        path = self.results.folder / CASE
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
            if not isinstance(content, dict):
                raise CaseError("a table of keys is needed")
        except (OSError, ValueError, RecursionError) as error:
            raise CaseError(
                f"the case of the run cannot be read from {path}: {error}; put a whole copy there"
            ) from error
        return load_case(content)

    def has(self, name: str) -> bool:
        """Return whether a field was written."""
        return name in self.grid.point_data or name in self.grid.cell_data

    def need(self, names: Sequence[str], purpose: str) -> None:
        """Check that fields were written.

        Raises:
            CaseError: names those that are missing, with the line that the case needs.
        """
        missing = [name for name in names if not self.has(name)]
        if not missing:
            return
        wanted = dict.fromkeys((*self._written_entries(), *map(entry_of, missing)))
        line = ", ".join(f'"{entry}"' for entry in wanted)
        raise CaseError(
            f"{', '.join(missing)} of {self.name!r} at {self.moment:g} s was not written, and "
            f"{purpose} needs it; run the case again with\n[output]\nfields = [{line}]"
        )

    def _written_entries(self) -> tuple[str, ...]:
        try:
            return tuple(self.case.output.fields)
        except CaseError:
            return tuple(Output.model_fields["fields"].default)

    def values(self, name: str) -> FloatArray:
        """Return a field of the nodes or the cells, components as in `Results.field`."""
        return self.results.field(name, self.name, self.time).values

    def in_cells(self, name: str) -> FloatArray:
        """Return a number in the cells, the mean of their nodes where it belongs to these."""
        values = self.values(name)
        return values if name in self.grid.cell_data else values[self.cells].mean(axis=1)

    @cached_property
    def displacement(self) -> FloatArray:
        """Displacement of the nodes, (nodes, 3) [m].

        Raises:
            CaseError: it was not written.
        """
        self.need(["displacement"], "a distorted shape")
        return np.asarray(self.grid.point_data["displacement"], dtype=np.float64)
