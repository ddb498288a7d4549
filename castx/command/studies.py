"""The commands of many runs: `castx vary`, `castx identify`, `castx optimise`."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from mpi4py import MPI

import typer

from castx.command.refusals import naming
from castx.command.terminal import EnduringConsole, output_of
from castx.errors import CaseError

if TYPE_CHECKING:
    from castx.studies.asked.identify import Identify
    from castx.studies.asked.reading import Study
    from castx.studies.asked.runner import Running
    from castx.studies.runs.executor import Executor
    from castx.studies.runs.runner import Runner

CaseFile = Annotated[Path, typer.Argument(metavar="CASE.toml", help="The case file.")]
Output = Annotated[
    Path | None, typer.Option(metavar="DIR", help="Folder of the study, instead of that it names.")
]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace a value, for instance time.end=10."),
]
Processes = Annotated[
    int | None, typer.Option(min=1, metavar="N", help="Runs at once; else one for each core.")
]
Anew = Annotated[bool, typer.Option("--anew", help="Make runs again that have failed.")]


@dataclass(frozen=True)
class Invocation:
    """Command line of a study."""

    case_file: Path
    overrides: tuple[str, ...]
    output: Path | None
    processes: int | None
    anew: bool


def refuse_ranks(comm: MPI.Intracomm) -> None:
    """Refuse a study on several ranks.

    Raises:
        CaseError: with the cure.
    """
    if comm.size > 1:
        raise CaseError(
            f"a study makes its runs itself, each on one rank, and was started on {comm.size}: "
            "leave mpirun out, and say with --processes how many it makes at once"
        )


def executor_of(asked: Invocation, study: Running, folder: Path) -> Executor:
    """Return the executor of a study: jobs of Slurm if it asks for them, else processes here."""
    from castx.studies.runs.local import LocalProcesses

    at_once = asked.processes or study.processes
    if study.slurm is None:
        return LocalProcesses(at_once, study.memory)
    from castx.studies.runs.slurm import JOBS, SlurmArrays

    return SlurmArrays(study.slurm, folder / JOBS, at_once, study.memory)


@contextmanager
def runner_of(asked: Invocation, study: Running, kind: str) -> Iterator[Runner]:
    """Open the folder of a study; what is asked to stop stops its runs too.

    Args:
        asked: the command line.
        study: its settings.
        kind: behind the name of the folder.
    """
    from castx.studies.runs.runner import Runner, study_folder

    folder = asked.output or study.folder or Path("results") / f"{asked.case_file.stem}.{kind}"
    executor = executor_of(asked, study, folder.resolve())
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        with study_folder(folder.resolve()) as opened:
            yield Runner(
                asked.case_file, asked.overrides, opened, executor, study.time_limit, asked.anew
            )
    finally:
        signal.signal(signal.SIGTERM, before)


@contextmanager
def opened(
    context: typer.Context, asked: Invocation, kind: type[Study], name: str
) -> Iterator[tuple[Study, Runner, EnduringConsole]]:
    """Read a study and open its folder; refusals name the case file.

    Args:
        context: of the command.
        asked: the command line.
        kind: of the study.
        name: of its table.
    """
    from castx.studies.asked.reading import read_study

    comm, console = output_of(context)
    refuse_ranks(comm)
    with naming(asked.case_file):
        study = read_study(asked.case_file, kind, asked.overrides)
        with runner_of(asked, study, name) as runner:
            yield study, runner, console


def vary(
    context: typer.Context,
    case_file: CaseFile,
    output: Output = None,
    processes: Processes = None,
    anew: Anew = False,
    overrides: Overrides = None,
) -> None:
    """Run a case many times with other numbers, as its [vary] says, and tell what matters."""
    from castx.studies.asked.vary import Vary
    from castx.studies.vary import PAGE, TABLE
    from castx.studies.vary import vary as make

    asked = Invocation(case_file, tuple(overrides or ()), output, processes, anew)
    with opened(context, asked, Vary, "vary") as (study, runner, console):
        found = make(runner, study)
    for one in found.importance:
        console.print(one.sentence, markup=False)
    say_runs(console, runner, len(found.table.runs))
    console.print(f"written: {runner.folder / PAGE}, {TABLE}", markup=False)


def say_runs(console: EnduringConsole, runner: Runner, count: int) -> None:
    """Show how many runs were made, what they cost, and how many were there already."""
    taken = timedelta(seconds=round(runner.processor_seconds))
    cost = f" in {taken} of processor time" if runner.made else ""
    console.print(f"{count} runs, {runner.made} of them made now{cost}", markup=False)


def identify(
    context: typer.Context,
    case_file: CaseFile,
    output: Output = None,
    processes: Processes = None,
    anew: Anew = False,
    design: Annotated[
        bool, typer.Option("--design", help="Say where the next thermocouple belongs instead.")
    ] = False,
    overrides: Overrides = None,
) -> None:
    """Identify numbers of a case from measured curves, as its [identify] says, with their bands."""
    from castx.studies.asked.identify import Identify
    from castx.studies.inverse.identify import PAGE
    from castx.studies.inverse.identify import identify as make
    from castx.studies.inverse.page import row

    asked = Invocation(case_file, tuple(overrides or ()), output, processes, anew)
    with opened(context, asked, Identify, "identify") as (read, runner, console):
        study = read.relative_to(case_file.resolve().parent)
        if design:
            show_design(runner, study, console, output_of(context)[0])
            return
        result = make(runner, study)
    for one in result.found.estimates:
        name, value, band, *_ = row(one)
        console.print(f"{name}: {value} (95 %: {band})", markup=False)
    for text in (*result.found.remarks, *result.found.unseen, *result.found.whiteness):
        console.print(text, markup=False)
    say_runs(console, runner, len(runner.used))
    console.print(f"written: {runner.folder / PAGE}, {result.case_file}", markup=False)


def show_design(
    runner: Runner, study: Identify, console: EnduringConsole, comm: MPI.Intracomm
) -> None:
    """Show in which order candidates should become sensors, what they would tell, and where."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    from castx.case.reading.read import load_case
    from castx.studies.inverse.design import RESULT, design
    from castx.studies.inverse.design_picture import PICTURE, draw_design

    found = design(runner, study)
    say_runs(console, runner, found.runs)
    console.print(
        "deviations, of ln where logarithms are sought, with each sensor and those before"
    )
    for title, order in (("D-optimal", found.d_order), ("A-optimal", found.a_order)):
        table = Table(title, "now", *(f"+ {one.name}" for one in order), box=SIMPLE_HEAD)
        for k, name in enumerate(found.numbers):
            values = [found.before[k], *(one.deviations[k] for one in order)]
            table.add_row(name, *(f"{value:.2g}" for value in values))
        console.print(table)
    case = load_case(runner.case_file, runner.overrides)
    picture = runner.folder / PICTURE
    try:
        draw_design(case, study.candidates, [one.name for one in found.d_order], comm, picture)
    except CaseError as error:
        console.print(f"no picture: {error}", markup=False, style="yellow")
    else:
        console.print(f"written: {picture}, {RESULT}", markup=False)


def optimise(
    context: typer.Context,
    case_file: CaseFile,
    output: Output = None,
    processes: Processes = None,
    anew: Anew = False,
    overrides: Overrides = None,
) -> None:
    """Look for the best numbers of a case, as its [optimise] says, by many runs."""
    from castx.studies.asked.optimise import Optimise
    from castx.studies.optimise import PAGE
    from castx.studies.optimise import optimise as make
    from castx.studies.table import with_unit

    asked = Invocation(case_file, tuple(overrides or ()), output, processes, anew)
    with opened(context, asked, Optimise, "optimise") as (study, runner, console):
        found = make(runner, study)
    table, best = found.table, found.best
    for name, unit, value in zip(table.inputs, table.units, table.values[best], strict=True):
        console.print(f"{with_unit(name, unit)}: {value:.5g}", markup=False)
    for name in dict.fromkeys((study.goal, *(limit.of for limit in study.limits))):
        answer = table.found[best][name]
        console.print(f"{with_unit(name, answer.unit)}: {answer.shown:.5g}", markup=False)
    for text in found.remarks:
        console.print(text, markup=False)
    say_runs(console, runner, len(table.runs))
    console.print(f"written: {runner.folder / PAGE}, {found.case_file}", markup=False)


STUDY_COMMANDS = (vary, identify, optimise)
