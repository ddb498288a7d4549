"""A run: from a case file to a results folder."""

from __future__ import annotations

import logging
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpi4py import MPI

from castx.case.case import Case
from castx.case.reading.read import load_case
from castx.case.unusual import unusual
from castx.checkpoint.file import Checkpoint
from castx.checkpoint.writing import Checkpoints, header_to_restart_from
from castx.command.progress import Progress
from castx.command.watches.deformations import DeformationWatch
from castx.command.watches.forces import ForceWatch
from castx.command.watches.interruption import Interruption
from castx.command.watches.ranges import RangeWatch
from castx.command.watches.skins import tell_of_skins
from castx.command.watches.temperatures import TemperatureWatch
from castx.process.simulation import Simulation
from castx.profiling import Profile
from castx.results.files.folder import claimed_folder
from castx.results.writing import ResultsWriter

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class RunSettings:
    """Settings of a run beside its case: ranks, restart, time limit, costs.

    Attributes:
        comm: the ranks to run on.
        restart: go on from the checkpoint in the results folder, on any number of ranks.
        time_limit: wall clock time before which to stop [s], of all runs of the command together.
        profile: write into run.json what the parts of the run have cost.
    """

    comm: MPI.Intracomm
    restart: bool = False
    time_limit: float | None = None
    profile: bool = False


def run(
    path: str | Path,
    overrides: Sequence[str] = (),
    *,
    output: str | Path | None = None,
    comm: MPI.Intracomm | None = None,
    restart: bool = False,
    time_limit: float | None = None,
    profile: bool = False,
) -> Path:
    """Run a case file and return its results folder; collective.

    >>> import castx
    >>> folder = castx.run("cylinder.toml", ["time.end=0.05", "geometry.size=1e-2"], output="short")
    t 0 s  step 0  solid 0.0 %
    t 0.05 s  step 1 (0.05 s)  solid ...
    >>> sorted(path.name for path in folder.iterdir())
    ['case.json', 'checkpoint', 'fields', 'history.csv', 'hot_spots.csv', 'probes.csv', 'run.json']

    Args:
        path: the case file.
        overrides: values in place of those of the file, such as "time.end=10".
        output: results folder in place of that of the file.
        comm: the ranks to run on; by default all.
        restart: go on from the checkpoint in the results folder, on any number of ranks.
        time_limit: wall clock time before which to stop [s].
        profile: write into run.json what the parts of the run have cost.

    Raises:
        CaseError: the case, its output folder, its checkpoint or a probe cannot be accepted.
        MeshError: the mesh lacks what the case asks of it.
        ConvergenceError: even the smallest step failed, or displacements are absurd; the last
            accepted state is on disk.
        StorageError: the disk does not take the results; the last checkpoint is on disk.
        KeyboardInterrupt: a signal or the time limit asked to stop; the last accepted state is on
            disk.
    """
    case = asked_case(path, overrides, output)
    ranks = MPI.COMM_WORLD if comm is None else comm
    return run_case(case, RunSettings(ranks, restart, time_limit, profile))


def restart_command(options: Mapping[str, Any]) -> str:
    """Return the command line that goes on with an interrupted run.

    Args:
        options: those of `castx run` by the names of its parameters.
    """
    words = ["castx", "run", str(options["case_file"])]
    for key in ("output", "time_limit", "sensitivity", "adapt"):
        if options[key] not in (None, 0):
            words += [f"--{key.replace('_', '-')}", str(options[key])]
    words += [f"--{key}" for key in ("estimate", "profile") if options[key]]
    for override in options["overrides"] or ():
        words += ["--set", override]
    return shlex.join([*words, "--restart"])


def asked_case(path: str | Path, overrides: Sequence[str], output: str | Path | None) -> Case:
    """Return a case as the command line asks for it.

    Args:
        path: the case file.
        overrides: values in place of those of the file.
        output: results folder in place of that of the file.

    Raises:
        CaseError: the case cannot be accepted.
    """
    case = load_case(Path(path), overrides)
    return case if output is None else with_output(case, Path(output))


def with_output(case: Case, folder: Path) -> Case:
    """Return the case with another results folder."""
    output = case.output.model_copy(update={"folder": Path.cwd() / folder})
    return case.model_copy(update={"output": output})


def run_case(case: Case, settings: RunSettings) -> Path:
    """Run a case and return its results folder; collective.

    Args:
        case: the case.
        settings: of the run.

    Raises:
        CaseError, MeshError, ConvergenceError, StorageError, KeyboardInterrupt: as in `run`.
    """
    comm = settings.comm
    costs = Profile(comm) if settings.profile else None
    limit = settings.time_limit
    with Interruption(comm, limit) as interruption, claimed_folder(case, comm) as folder:
        checkpoint = Checkpoint(folder, comm)
        header = header_to_restart_from(case, checkpoint) if settings.restart else None
        simulation = Simulation.from_case(case, comm)
        for doubt in unusual(case) if comm.rank == 0 else ():
            _log.warning(doubt)
        tell_of_skins(case, simulation.mesh)
        results = ResultsWriter(case, simulation.mesh, simulation.pairs)
        checkpoints = Checkpoints(checkpoint, case, simulation, results)
        if header is not None:
            checkpoints.restore(header)
        interruption.at_once = results.note_interruption
        interruption.check()
        if header is None or not simulation.is_finished:
            _solve(case, simulation, results, checkpoints, interruption, costs)
    return folder


def _solve(
    case: Case,
    simulation: Simulation,
    results: ResultsWriter,
    checkpoints: Checkpoints,
    interruption: Interruption,
    profile: Profile | None,
) -> None:
    comm = simulation.mesh.comm
    ranges, forces = RangeWatch(case, comm), ForceWatch(case, comm)
    deformation, temperatures = DeformationWatch(case, comm), TemperatureWatch(case, comm)
    progress = Progress(simulation.end, comm, largest=case.time.largest_step)
    with results, checkpoints, forces, ranges, progress:
        for snapshot in simulation.states(after_failed_try=interruption.after_try):
            results.write(snapshot)
            checkpoints.write_when_due()
            progress.show(snapshot)
            temperatures.check(snapshot)
            ranges.check(snapshot)
            deformation.check(snapshot)
            forces.check(snapshot)
            if snapshot.step == 0:
                interruption.check()
            elif not simulation.is_finished:
                interruption.after_try()
        if profile is not None:
            results.note_profile(profile.costs())
