"""Runs in meshes that follow the errors of the run before, and how their numbers change."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import count as count_from
from itertools import takewhile
from pathlib import Path

from mpi4py import MPI

from rich.box import SIMPLE_HEAD
from rich.table import Table

from castx.case.case import Case
from castx.case.reading.adapted import error_fields, with_fields, with_size_map
from castx.command.beside.next_sizes import write_next_sizes
from castx.command.beside.runs import run_beside
from castx.command.run import RunSettings, with_output
from castx.errors import CaseError
from castx.ranks import on_first_rank
from castx.report.summary.finding import Finding
from castx.report.summary.registry import findings
from castx.results.files.folder import RECORD, keep_results
from castx.results.files.reason import Reason
from castx.results.files.run_json import number_of_cells
from castx.results.reading import Results
from castx.results.writing import wanted_entries


def run_adapted(case: Case, settings: RunSettings, *, rounds: int) -> Path:
    """Run a case, then in meshes adapted to its errors; return its results folder; collective.

    The other runs stand in folders inside it, adapted_1 and so on, with the sizes of their cells
    in sizes_1.vtu beside them.

    Args:
        case: the case.
        settings: of all runs.
        rounds: how often the mesh is adapted.

    Raises:
        CaseError: the case is not meshed from CAD, or as in `castx.run`.
        MeshError, ConvergenceError, StorageError, KeyboardInterrupt: as in `castx.run`; where a run
            in an adapted mesh does not converge, there is none behind it.
    """
    if case.geometry.cad is None:
        raise CaseError(
            "--adapt meshes CAD parts again; the meshes of files stay as they are, and those of "
            "generators follow geometry.size and geometry.interface_size"
        )
    folder = case.output.folder
    fields = list(dict.fromkeys([*wanted_entries(case), *error_fields(case)]))
    case = with_output(with_fields(case, fields), folder)
    comm = settings.comm
    if not settings.restart:
        on_first_rank(comm, lambda: [keep_results(there) for there in _adapted_folders(folder)])
    return run_beside(case, _adapted(case, rounds, comm), settings)


def _adapted(case: Case, rounds: int, comm: MPI.Intracomm) -> Iterator[Case]:
    """Yield the case in each next mesh, once the run in the one before it has ended."""
    present, folder = case, case.output.folder
    for count in range(1, rounds + 1):
        if not on_first_rank(comm, lambda: _finished(present.output.folder)):  # noqa: B023
            return
        sizes = folder / f"sizes_{count}.vtu"
        on_first_rank(comm, lambda: write_next_sizes(present, sizes))  # noqa: B023
        present = with_output(with_size_map(case, sizes), folder / _name(count))
        yield present


def _adapted_folders(folder: Path) -> list[Path]:
    """Return the folders with results in adapted meshes, inside those of the run itself."""
    named = (folder / _name(count) for count in count_from(1))
    return list(takewhile(lambda there: (there / RECORD).is_file(), named))


def _name(count: int) -> str:
    return f"adapted_{count}"


def _finished(folder: Path) -> bool:
    return bool(Results(folder).record["exit"]["reason"] == Reason.FINISHED)


def adapted_table(folder: Path) -> Table:
    """Return a table of the numbers of a run in its own mesh and in the adapted ones.

    Args:
        folder: results of the run itself.
    """
    runs = [Results(there) for there in (folder, *_adapted_folders(folder))]
    numbers = [{found.name: found for found in findings(run)} for run in runs]
    table = Table("number", box=SIMPLE_HEAD, caption=f"castx report {runs[-1].folder}")
    for count, run in enumerate(runs):
        mesh = _name(count) if count else "own mesh"
        table.add_column(f"{mesh}\n{number_of_cells(run.record)} cells", justify="right")
    table.add_column("last change", justify="right")
    for name, finding in numbers[0].items():
        values = [of_run.get(name) for of_run in numbers]
        if len({found.value for found in values if found is not None}) == 1 < len(values):
            continue  # of the material, not of the mesh
        table.add_row(name, *(_text(finding, value) for value in values), _change(values))
    return table


def _text(finding: Finding, other: Finding | None) -> str:
    return "" if other is None else replace(finding, value=other.value).number


def _change(values: Sequence[Finding | None]) -> str:
    """Return by how much the last mesh has changed a number, in percent of what it was."""
    before, last = values[-2:] if len(values) > 1 else (None, None)
    if before is None or last is None or before.value == 0.0 or before.unit in ("°C", "%"):
        return ""
    return f"{100.0 * (last.value / before.value - 1.0):+.1f} %"
