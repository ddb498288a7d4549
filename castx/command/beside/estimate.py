"""A run beside runs in a coarser mesh and in larger steps: how far off its numbers are."""

from __future__ import annotations

import logging
from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.table import Table

from castx.case.case import Case
from castx.case.reading.coarser import with_coarser_mesh, with_larger_steps
from castx.command.beside.runs import run_beside
from castx.command.run import RunSettings, with_output
from castx.errors import CaseError
from castx.ranks import on_first_rank
from castx.report.summary.estimated import error_texts
from castx.report.summary.registry import findings
from castx.results.files.estimate import Coarser, Estimate, read_estimate, write_estimate
from castx.results.files.run_json import number_of_cells
from castx.results.reading import Results

RATIO = 2.0
"""Of the sizes of cells and steps to those of the run itself: smaller ones drown in the noise with
which freezing times and gaps follow the place of a front in its cell."""
LEAST_RATIO = 1.1
"""Of the sizes of cells that a coarser mesh must really have: thin walls may forbid larger ones."""
MESH, STEPS = "estimate_mesh", "estimate_steps"

log = logging.getLogger(__name__)


def run_estimate(case: Case, settings: RunSettings) -> Path:
    """Run a case, then in a coarser mesh and in larger steps; return its results; collective.

    The other runs stand in folders inside it, and what all have given in estimate.json.

    Args:
        case: the case.
        settings: of all runs.

    Raises:
        CaseError, MeshError, ConvergenceError, StorageError, KeyboardInterrupt: as in `castx.run`.
    """
    folder = case.output.folder
    steps = with_output(with_larger_steps(case, RATIO), folder / STEPS)
    mesh = None
    try:
        mesh = with_output(with_coarser_mesh(case, RATIO), folder / MESH)
    except CaseError as error:
        log.warning("errors by the mesh are not estimated: %s", error)
    others = [other for other in (mesh, steps) if other is not None]
    run_beside(case, others, settings)
    on_first_rank(settings.comm, lambda: write_estimate(folder, estimated(case, mesh, steps)))
    return folder


def estimated(case: Case, mesh: Case | None, steps: Case) -> Estimate:
    """Return the results of finished runs, read from their folders.

    Args:
        case: the run itself.
        mesh: in a coarser mesh; None: there is none.
        steps: in larger steps.
    """
    own = Results(case.output.folder)
    return Estimate(
        reached=own.record["time_reached"],
        values=_values(own),
        mesh=None if mesh is None else _coarser_mesh(own, mesh, case.geometry.gdim),
        steps=_given(Results(steps.output.folder), own, RATIO),
    )


def _coarser_mesh(own: Results, mesh: Case, dimension: int) -> Coarser | None:
    """Return the run in a coarser mesh, or nothing where it is hardly coarser."""
    other = Results(mesh.output.folder)
    cells, fewer = (number_of_cells(run.record) for run in (own, other))
    ratio = float((cells / fewer) ** (1.0 / dimension))
    if ratio < LEAST_RATIO:
        log.warning(
            "errors by the mesh are not estimated: its cells cannot be made larger than by a "
            "factor of %.3g",
            ratio,
        )
        return None
    return _given(other, own, ratio)


def _given(other: Results, own: Results, ratio: float) -> Coarser:
    """Return the numbers of a run that has gone as far as the run itself; of another one none."""
    whole = other.record["time_reached"] == own.record["time_reached"]
    return Coarser(
        folder=str(other.folder.relative_to(own.folder)),
        ratio=ratio,
        ended=other.record["exit"]["reason"],
        values=_values(other) if whole else {},
    )


def _values(run: Results) -> dict[str, float]:
    return {finding.name: float(finding.value) for finding in findings(run)}


def estimate_table(folder: Path) -> Table:
    """Return a table with the numbers of a run and how far they are off.

    Raises:
        CaseError: the folder holds no estimate.
    """
    found = read_estimate(folder)
    if found is None:
        raise CaseError(f"{folder} has no runs in a coarser mesh and in larger steps")
    table = Table("number", "value", "error by the mesh", "by the steps", box=SIMPLE_HEAD)
    for finding in findings(Results(folder)):
        texts = error_texts(finding, found)
        if any(texts):
            table.add_row(finding.name, finding.number, *texts)
    return table
