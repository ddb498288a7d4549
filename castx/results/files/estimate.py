"""estimate.json: errors of the numbers of a run, by a coarser mesh and by larger steps.

Errors of castx fall in proportion to the sizes of cells and steps, so that with values f in a mesh
and c in one whose cells are r times as large a mesh without end would change f by (f - c)/(r - 1):
L. F. Richardson, Philosophical Transactions A 210 (1911) 307.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from pydantic import Field

from castx.results.files.folder import ESTIMATE
from castx.results.files.json_contents import JsonContents, read_json, write_json


class Coarser(JsonContents):
    """A run beside the run itself.

    Attributes:
        folder: its results, relative to those of the run itself.
        ratio: r, of the sizes of its cells or steps to those of the run itself.
        ended: why it ended, "finished" or "not converged".
        values: its numbers by the names of findings, in SI.
    """

    folder: str
    ratio: float = Field(gt=1.0)
    ended: str
    values: Mapping[str, float]

    def change(self, name: str, value: float) -> float | None:
        """Return by what a number would change with cells or steps without end in number.

        Args:
            name: of the number.
            value: that the run itself has given.
        """
        other = self.values.get(name)
        return None if other is None else (value - other) / (self.ratio - 1.0)


class Estimate(JsonContents):
    """Numbers of a run, and of runs in a coarser mesh and in larger steps.

    Attributes:
        reached: time up to which the run went [s].
        values: its numbers by the names of findings, in SI.
        mesh: the run in a coarser mesh; None: the mesh cannot be made coarser.
        steps: the run in larger steps.
    """

    reached: float
    values: Mapping[str, float]
    mesh: Coarser | None
    steps: Coarser

    def changes(self, name: str) -> tuple[float | None, float | None]:
        """Return by what a number would change in a fine mesh and in small steps, where known."""
        value = self.values[name]
        by_mesh = None if self.mesh is None else self.mesh.change(name, value)
        return by_mesh, self.steps.change(name, value)


def write_estimate(folder: Path, found: Estimate) -> None:
    """Write the file into the results folder of the run itself."""
    write_json(folder / ESTIMATE, found)


def read_estimate(folder: Path) -> Estimate | None:
    """Return the contents of the file in a results folder; None where there is none.

    Raises:
        CaseError: the file is broken.
    """
    return read_json(folder / ESTIMATE, Estimate)
