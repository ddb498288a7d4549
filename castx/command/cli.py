"""The command `castx` and its exit codes, which are the same on all ranks."""

from __future__ import annotations

import gc
import logging
import sys
import traceback
from collections.abc import Sequence
from contextlib import suppress
from enum import IntEnum
from pathlib import Path
from typing import Annotated, cast

from mpi4py import MPI

import typer

from castx.command.foreign import verify
from castx.command.look_up import interfaces, materials
from castx.command.new import new
from castx.command.refusals import naming, seconds
from castx.command.scheil import scheil
from castx.command.studies import STUDY_COMMANDS, CaseFile, Overrides, Processes
from castx.command.terminal import (
    LINES,
    Detail,
    VariedNumber,
    console_of,
    output_of,
    prepare_logging,
    show_details,
)
from castx.commit import commit
from castx.errors import (
    CaseError,
    ConvergenceError,
    Interrupted,
    MeshError,
    StorageError,
    UnsettledFit,
)
from castx.handover.target import Target
from castx.imports import kept
from castx.input.printable import printable
from castx.ranks import common_code, on_first_rank
from castx.version import __version__

UsageError = cast(type[typer.BadParameter], typer.BadParameter.__base__)
"""A command line that is wrong; typer exports this base class of `BadParameter` by no name."""

app = typer.Typer(
    name="castx",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
)

AFTER_FAILURE = (
    "The last accepted state and a checkpoint are in the results folder. After a change of solver, "
    "coupling.passes or time.smallest_step the run goes on with --restart; after others it has to "
    "begin anew."
)

WITHOUT_DOCSTRINGS = (
    "Python runs without docstrings (PYTHONOPTIMIZE=2 or -OO), from which parsers below DOLFINx "
    "take their grammar; unset PYTHONOPTIMIZE, or set it to 1"
)


class Exit(IntEnum):
    """Exit codes of the command."""

    DONE = 0
    FAILED = 1
    REFUSED = 2
    NOT_CONVERGED = 3
    INTERRUPTED = 130


def main() -> None:
    """Run the command line and exit with its code."""
    code = execute(sys.argv[1:], MPI.COMM_WORLD)
    gc.freeze()  # the end of the process gives all back, without a search for what is garbage
    sys.exit(code)


def execute(arguments: Sequence[str], comm: MPI.Intracomm) -> int:
    """Run a command line and return its exit code, the same on all ranks; collective.

    What castx refuses or gives up is raised on all ranks and shown by rank 0. Anything else is a
    bug that may have struck one rank alone, so that it ends all of them.
    """
    prepare_logging(comm)
    if sys.flags.optimize > 1:
        return say(comm, WITHOUT_DOCSTRINGS, Exit.REFUSED)
    verdicts = comm.Dup()
    try:
        return common_code(verdicts, exit_code(arguments, comm))
    finally:
        verdicts.Free()


def exit_code(arguments: Sequence[str], comm: MPI.Intracomm) -> int:
    """Run a command line and return the exit code of this rank."""
    try:
        code = app(list(arguments), standalone_mode=False, obj=comm, prog_name="castx")
        return int(code or Exit.DONE)
    except UsageError as error:
        if comm.rank == 0:
            error.message = printable(error.message, LINES)
            error.show()
        return Exit.REFUSED
    except (CaseError, MeshError) as error:
        return say(comm, error, Exit.REFUSED)
    except UnsettledFit as error:
        return say(comm, f"not converged: {error}", Exit.NOT_CONVERGED)
    except ConvergenceError as error:
        return say(comm, f"not converged: {error}\n{AFTER_FAILURE}", Exit.NOT_CONVERGED)
    except StorageError as error:
        return say(comm, error, Exit.FAILED)
    except (KeyboardInterrupt, typer.Abort):
        return say(comm, "interrupted", Exit.INTERRUPTED)
    except BaseException:  # also that a library wants to exit, perhaps on one rank alone
        with suppress(OSError, AttributeError):  # of a closed error output
            sys.stderr.write(printable(traceback.format_exc(), LINES))
            sys.stderr.flush()
        if comm.size > 1:
            comm.Abort(Exit.FAILED)
        return Exit.FAILED


def say(comm: MPI.Intracomm, message: object, code: Exit) -> Exit:
    """Show an error or a text on the standard error output of rank 0 and return the exit code."""
    console_of(comm, stderr=True).print(f"castx: {message}", markup=False)
    return code


def show_version(context: typer.Context, wanted: bool) -> None:
    """Show the version of castx and its commit on rank 0, and end there."""
    if wanted:
        if context.obj.rank == 0:
            typer.echo(f"castx {__version__} (commit {commit()})")
        raise typer.Exit


@app.callback()
def castx_command(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=show_version, is_eager=True, help="Show the version and exit."
        ),
    ] = False,
) -> None:
    """Thermo-mechanics of metal casting: solidification, stress, contact, air gaps."""


@app.command()
def run(
    context: typer.Context,
    case_file: CaseFile,
    output: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Results folder, instead of output.folder.")
    ] = None,
    restart: Annotated[
        bool, typer.Option("--restart", help="Go on from the checkpoint in the results folder.")
    ] = False,
    time_limit: Annotated[
        str | None, typer.Option(metavar="TIME", help='Stop with a checkpoint before this: "8 h".')
    ] = None,
    log: Annotated[
        list[Detail] | None, typer.Option(help="Show the residuals of each Newton iteration.")
    ] = None,
    profile: Annotated[
        bool, typer.Option("--profile", help="Show what the parts of the run have cost.")
    ] = False,
    sensitivity: Annotated[
        VariedNumber | None, typer.Option(help="Run with this a little lower and higher too.")
    ] = None,
    estimate: Annotated[
        bool, typer.Option("--estimate", help="Estimate errors by a coarser mesh and larger steps.")
    ] = False,
    adapt: Annotated[
        int, typer.Option(metavar="N", min=0, max=5, help="Mesh again by the errors, N times.")
    ] = 0,
    overrides: Overrides = None,
) -> None:
    """Solve a case and write its results folder."""
    with kept():
        from castx.command.beside.choice import chosen
        from castx.command.run import RunSettings, asked_case, restart_command
        from castx.environment import blas_advantage, blas_warning

    solve, tables = chosen(sensitivity, adapt, estimate=estimate, profile=profile)
    comm, console = output_of(context)
    show_details(comm, log or ())
    if comm.rank == 0 and (warning := blas_warning(blas_advantage())):
        logging.getLogger(__name__).warning(warning)
    limit = None if time_limit is None else seconds("--time-limit", time_limit)
    try:
        with naming(case_file):
            case = asked_case(case_file, overrides or (), output)
            folder = solve(case, RunSettings(comm, restart, limit, profile))
    except KeyboardInterrupt as error:  # typer would not say why
        told = f"interrupted: {error}".removesuffix(": ")
        if isinstance(error, Interrupted):  # behind a checkpoint
            told += f"; go on with\n{restart_command(context.params)}"
        say(comm, told, Exit.INTERRUPTED)
        raise typer.Exit(Exit.INTERRUPTED) from None
    for table in tables if comm.rank == 0 else ():
        console.print(table(folder))
    console.print(f"done: {folder}\npictures and curves: castx report {folder}", markup=False)


@app.command()
def check(
    context: typer.Context,
    case_file: CaseFile,
    picture: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Draw bodies, surfaces, interfaces: .png, .svg, .pdf."),
    ] = None,
    overrides: Overrides = None,
) -> None:
    """Validate a case, build its mesh and name its bodies, surfaces and interfaces; no solve."""
    with kept():
        from castx.case.reading.read import load_case
        from castx.command.check import check_case
        from castx.studies.inverse.checking import refuse_useless_studies

    comm, console = output_of(context)
    with naming(case_file):
        studies = on_first_rank(comm, lambda: refuse_useless_studies(case_file, overrides or ()))
        check_case(load_case(case_file, overrides or ()), comm, console, picture)
    for name in studies:
        console.print(f"[{name}] can begin: castx {name} {case_file}", markup=False)
    console.refuse_loss()


@app.command()
def mesh(
    context: typer.Context,
    case_file: CaseFile,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="PART.msh", help="The file: .msh, .vtu, .inp, …"),
    ],
    overrides: Overrides = None,
) -> None:
    """Write the mesh of a case for gmsh (.msh) or another program (.vtu, .inp, .med, …)."""
    with kept():
        from castx.case.reading.read import load_case
        from castx.domain.memory import refuse_too_large
        from castx.domain.source import write_mesh

    comm, console = output_of(context)
    with naming(case_file):
        case = load_case(case_file, overrides or ())
        names = [body.name for body in case.bodies]
        refuse_too_large(case.geometry, names, comm, solved=False)
        on_first_rank(comm, lambda: write_mesh(case.geometry, output, names))
    console.print(f"written: {output}", markup=False)


app.command()(new)


@app.command()
def report(
    context: typer.Context,
    folders: Annotated[
        list[Path], typer.Argument(metavar="DIR…", help="A results folder, or several to compare.")
    ],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE.html", help="Instead of comparison.html."),
    ] = None,
) -> None:
    """Write report.html into a results folder; of several, comparison.html here."""
    with kept():
        from castx.report.page.comparison import write_page

    comm, console = output_of(context)
    if comm.rank == 0:
        console.print(f"written: {write_page(folders, output)}", markup=False)


@app.command()
def export(
    context: typer.Context,
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A results folder.")],
    to: Annotated[Target, typer.Option(help="What to write.")],
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="PATH", help="The file; for calculix a folder."),
    ],
    body: Annotated[str | None, typer.Option(metavar="NAME", help="Else what freezes.")] = None,
    time: Annotated[str | None, typer.Option(metavar="TIME", help="Else the last.")] = None,
    stage: Annotated[int | None, typer.Option(metavar="N", help="Its end, from 0.")] = None,
    release: Annotated[bool, typer.Option("--release", help="calculix: without forces.")] = False,
    elastic: Annotated[bool, typer.Option("--elastic", help="calculix: cannot yield.")] = False,
    spacing: Annotated[str | None, typer.Option(help='exaca: of the grid, "20 um".')] = None,
    fit: Annotated[bool, typer.Option("--fit", help="stl, mould: as it fits best.")] = False,
    mesh: Annotated[
        Path | None, typer.Option(metavar="PART.msh", help="mould: move the nodes of this mesh.")
    ] = None,
    nominal: Annotated[
        Path | None, typer.Option(metavar="DIR", help="mould: results of the wanted part.")
    ] = None,
) -> None:
    """Hand a body over: to CalculiX, as tables, as its distorted or compensated surface."""
    with kept():
        from castx.handover.export import Request, exported

    comm, console = output_of(context)
    request = Request(
        folder, to, output, body, time, stage, release, elastic, spacing, fit, mesh, nominal
    )
    for line in on_first_rank(comm, lambda: exported(request)):
        style = "yellow" if line.startswith("warning") else None
        console.print(line, markup=False, style=style)


app.command()(materials)
for command in (scheil, verify, *STUDY_COMMANDS):
    app.command()(command)


@app.command()
def validate(
    context: typer.Context,
    name: Annotated[str | None, typer.Argument(metavar="[NAME]", help="Of one of them.")] = None,
    folder: Annotated[Path, typer.Option(metavar="DIR", help="Of all.")] = Path("validation"),
    output: Annotated[Path, typer.Option(metavar="DIR")] = Path("results/validation"),
    processes: Processes = None,
) -> None:
    """List the experiments, or run the case of one and compare it with what was measured."""
    from castx.command.run import run as run_case_file
    from castx.command.validate import list_or_validate
    from castx.studies.runs.local import LocalProcesses

    executor = LocalProcesses(processes)
    list_or_validate(name, folder, output, *output_of(context), run_case_file, executor)


app.command()(interfaces)


@app.command("app")
def local_page(
    context: typer.Context,
    folder: Annotated[Path, typer.Argument(metavar="[DIR]", help="With case files.")] = Path("."),
    port: Annotated[int, typer.Option(min=0, max=65535, help="Of 127.0.0.1; 0: a free one.")] = 0,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Print the address only.")
    ] = False,
) -> None:
    """Serve a local page for case files: edit, check, name faces, run, watch, report."""
    from castx.app.installed import refuse_missing_server

    comm, console = output_of(context)
    refuse_missing_server(comm.size)
    from castx.app.serving import serve

    serve(folder, port, not no_browser, lambda text: console.print(text, markup=False))


@app.command()
def info(context: typer.Context) -> None:
    """Show the versions of castx and of its dependencies, and whether the BLAS is fast."""
    from castx.command.listing import version_table
    from castx.environment import blas_advantage, blas_warning

    _, console = output_of(context)
    console.print(version_table())
    console.print(blas_warning(blas_advantage()) or "the BLAS in use is fast", markup=False)
    console.refuse_loss()
