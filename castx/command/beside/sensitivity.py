"""A run beside runs with another coherency: how much freezing time and gaps hang on it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.table import Table

from castx.case.case import Case
from castx.case.coherency import coherencies
from castx.case.reading.with_coherency import with_coherency
from castx.command.beside.runs import run_beside
from castx.command.run import RunSettings, with_output
from castx.command.terminal import VariedNumber
from castx.errors import CaseError
from castx.ranks import on_first_rank
from castx.report.summary.freezing import LAST_LIQUID, freezing
from castx.report.summary.gaps import gaps
from castx.results.files.sensitivity import (
    Sensitivity,
    VariedRun,
    read_sensitivity,
    write_sensitivity,
)
from castx.results.reading import Results

SHIFTS = (-0.05, 0.05)
"""By what coherency is moved."""


def run_sensitivity(case: Case, settings: RunSettings) -> Path:
    """Run a case, then with another coherency, and return its results folder; collective.

    The other runs stand in folders inside it, and what all have given in sensitivity.json.

    Args:
        case: the case.
        settings: of all runs.

    Raises:
        CaseError: no body has a coherency, or as in `castx.run`.
        MeshError, ConvergenceError, StorageError, KeyboardInterrupt: as in `castx.run`; where a
            run with another coherency does not converge, its row says so instead.
    """
    others = list(_others(case))  # refused before anything is solved
    folder = run_beside(case, others, settings)
    on_first_rank(settings.comm, lambda: write_sensitivity(folder, compared([case, *others])))
    return folder


def _others(case: Case) -> Iterator[Case]:
    """Yield the case with each other coherency that differs from its own."""
    own = _values(case)
    for shift in SHIFTS:
        other = with_coherency(case, shift)
        if _values(other) != own:
            name = f"{VariedNumber.COHERENCY}_{'lower' if shift < 0 else 'higher'}"
            yield with_output(other, case.output.folder / name)


def _values(case: Case) -> dict[str, float]:
    return {found.body: found.value for found in coherencies(case)}


def compared(cases: Sequence[Case]) -> Sensitivity:
    """Return the results of runs, read from their folders.

    Args:
        cases: the run itself first.
    """
    folder = cases[0].output.folder
    runs = [given_by(case, folder) for case in cases]
    rising = sorted(runs, key=lambda run: sum(run.coherency.values()))
    return Sensitivity(of=VariedNumber.COHERENCY, runs=tuple(rising))


def given_by(case: Case, folder: Path) -> VariedRun:
    """Return the results of the finished run of a case.

    Args:
        case: the case.
        folder: of the results of the run itself.
    """
    run = Results(case.output.folder)
    return VariedRun(
        folder=str(case.output.folder.relative_to(folder)),
        coherency=_values(case),
        ended=run.record["exit"]["reason"],
        reached=run.record["time_reached"],
        frozen={
            found.of: found.value if found.topic == LAST_LIQUID else None for found in freezing(run)
        },
        gaps={found.of: found.value for found in gaps(run)},
    )


def sensitivity_table(folder: Path) -> Table:
    """Return a table with freezing times and largest gaps of a run and those beside it.

    Raises:
        CaseError: the folder holds none of this.
    """
    found = read_sensitivity(folder)
    if found is None:
        raise CaseError(f"{folder} has no runs with another coherency")
    headings = [f"{name} frozen" for name in found.castings]
    headings += [f"largest gap {name}" for name in found.interfaces]
    table = Table(found.of, *headings, "results", box=SIMPLE_HEAD)
    for run in found.runs:
        texts = [run.freezing_text(name) for name in found.castings]
        texts += [run.gap_text(name) for name in found.interfaces]
        table.add_row(run.number(), *texts, run.folder)
    return table
