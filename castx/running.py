"""A case from its file to its results folder."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from mpi4py import MPI

from castx.case import Case, load_case
from castx.interruption import Interruption
from castx.progress import Progress
from castx.ranges import RangeWatch
from castx.results import Results
from castx.simulation import Simulation


def run(
    path: str | Path,
    overrides: Sequence[str] = (),
    *,
    output: str | Path | None = None,
    comm: MPI.Intracomm | None = None,
) -> Path:
    """Run a case file and return its results folder; collective.

    Args:
        path: the case file.
        overrides: values in place of those of the file, such as "time.end=10".
        output: results folder in place of that of the file.
        comm: the ranks to run on; by default all.

    Raises:
        CaseError: the case, its output folder or a probe cannot be accepted.
        MeshError: the mesh does not hold what the case asks of it.
        ConvergenceError: even the smallest step failed; the last accepted state is on disk.
        KeyboardInterrupt: a signal asked to stop; the last accepted state is on disk.
    """
    case = load_case(Path(path), overrides)
    if output is not None:
        case = with_output(case, Path(output))
    return run_case(case, MPI.COMM_WORLD if comm is None else comm)


def with_output(case: Case, folder: Path) -> Case:
    """Return the case with another results folder."""
    output = case.output.model_copy(update={"folder": Path.cwd() / folder})
    return case.model_copy(update={"output": output})


def run_case(case: Case, comm: MPI.Intracomm) -> Path:
    """Run a case and return its results folder; collective. Raises as `run` does."""
    simulation = Simulation.from_case(case, comm)
    ranges = RangeWatch(case, comm)
    with (
        Results(case, simulation.mesh, simulation.pairs) as results,
        Interruption(comm, results.note_interruption) as interruption,
        Progress(case.time.end, comm) as progress,
    ):
        for snapshot in simulation:
            results.write(snapshot)
            progress.show(snapshot)
            ranges.look(snapshot)
            interruption.check()
    return case.output.folder
