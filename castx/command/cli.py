"""The command `castx` and its exit codes, which are the same on all ranks."""

from __future__ import annotations

import logging
import sys
import traceback
from collections.abc import Sequence
from contextlib import suppress
from enum import IntEnum, StrEnum
from pathlib import Path
from typing import Annotated, cast

from mpi4py import MPI

import typer
from rich.logging import RichHandler

from castx.command.refusals import naming, seconds
from castx.command.terminal import LINES, EnduringConsole, console_of, endure_broken_pipes
from castx.errors import CaseError, ConvergenceError, MeshError, StorageError
from castx.input.printable import printable
from castx.ranks import common_code, on_first_rank

CaseFile = Annotated[Path, typer.Argument(metavar="CASE.toml", help="The case file.")]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace a value, for instance time.end=10."),
]

UsageError = cast(type[typer.BadParameter], typer.BadParameter.__base__)
"""A command line that is wrong; typer exports this base class of `BadParameter` by no name."""

app = typer.Typer(
    name="castx",
    help="Thermo-mechanics of metal casting: solidification, stress, contact, air gaps.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
)

AFTER_FAILURE = (
    "The last accepted state and a checkpoint are in the results folder. After a change of solver, "
    "coupling.passes or time.smallest_step the run goes on with --restart; after others it has to "
    "begin anew."
)


class Detail(StrEnum):
    """A part of the solution of which a run can show every iteration."""

    NEWTON = "newton"

    @property
    def modules(self) -> tuple[str, ...]:
        """Names of the loggers."""
        return {Detail.NEWTON: ("castx.process.simulation", "castx.solvers.snes")}[self]


class Exit(IntEnum):
    """Exit codes of the command."""

    DONE = 0
    FAILED = 1
    REFUSED = 2
    NOT_CONVERGED = 3
    INTERRUPTED = 130


def main() -> None:
    """Run the command line and exit with its code."""
    sys.exit(execute(sys.argv[1:], MPI.COMM_WORLD))


def execute(arguments: Sequence[str], comm: MPI.Intracomm) -> int:
    """Run a command line and return its exit code, the same on all ranks; collective.

    What castx refuses or gives up is raised on all ranks and shown by rank 0. Anything else is a
    bug that may have struck one rank alone, so that it ends all of them.
    """
    prepare_logging(comm)
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
    """Show a message on the standard error output of rank 0 and return the exit code.

    Args:
        comm: the ranks.
        message: an error or a text.
        code: the exit code.
    """
    console_of(comm, stderr=True).print(f"castx: {message}", markup=False)
    return code


def prepare_logging(comm: MPI.Intracomm) -> None:
    """Show the messages of castx on rank 0, and on other ranks critical ones only."""
    console = console_of(comm, stderr=True)
    handler = RichHandler(console=console, show_time=False, show_path=False)
    handler.addFilter(make_printable)
    level = logging.INFO if comm.rank == 0 else logging.CRITICAL
    logger = logging.getLogger("castx")
    logger.handlers = [handler]
    logger.setLevel(level)
    logger.propagate = False
    show_details(comm, ())


def make_printable(record: logging.LogRecord) -> bool:
    """Write out the control characters of a message, and let it pass."""
    record.msg, record.args = printable(record.getMessage(), LINES), None
    return True


def show_details(comm: MPI.Intracomm, details: Sequence[Detail]) -> None:
    """Show on rank 0 the messages of these details, and of no others."""
    for detail in Detail:
        level = logging.DEBUG if detail in details and comm.rank == 0 else logging.NOTSET
        for module in detail.modules:
            logging.getLogger(module).setLevel(level)


def output_of(context: typer.Context) -> tuple[MPI.Intracomm, EnduringConsole]:
    """Return the ranks, and a console that is silent on all but the first.

    Call it when all libraries are loaded that the command needs.
    """
    endure_broken_pipes()
    comm: MPI.Intracomm = context.obj
    return comm, console_of(comm)


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
        str | None,
        typer.Option(metavar="TIME", help='Stop with a checkpoint before this: "8 h".'),
    ] = None,
    log: Annotated[
        list[Detail] | None,
        typer.Option(help="Show the residuals of each Newton iteration."),
    ] = None,
    profile: Annotated[
        bool, typer.Option("--profile", help="Show what the parts of the run have cost.")
    ] = False,
    overrides: Overrides = None,
) -> None:
    """Solve a case and write its results folder."""
    from castx.command.listing import profile_table
    from castx.command.run import run as run_case_file
    from castx.environment import blas_advantage, blas_warning

    comm, console = output_of(context)
    show_details(comm, log or ())
    if comm.rank == 0 and (warning := blas_warning(blas_advantage())):
        logging.getLogger(__name__).warning(warning)
    limit = None if time_limit is None else seconds("--time-limit", time_limit)
    try:
        with naming(case_file):
            folder = run_case_file(
                case_file, overrides or (), output=output, comm=comm, restart=restart,
                time_limit=limit, profile=profile,
            )  # fmt: skip
    except KeyboardInterrupt as error:  # typer would not say why
        say(comm, f"interrupted: {error}".removesuffix(": "), Exit.INTERRUPTED)
        raise typer.Exit(Exit.INTERRUPTED) from None
    if profile and comm.rank == 0:
        console.print(profile_table(folder))
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
    from castx.case.reading.read import load_case
    from castx.command.check import check_case

    comm, console = output_of(context)
    with naming(case_file):
        check_case(load_case(case_file, overrides or ()), comm, console, picture)
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


@app.command()
def new(
    context: typer.Context,
    cad_file: Annotated[
        Path, typer.Argument(metavar="PART.step", help="CAD solids: .step, .iges or .brep.")
    ],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="CASE.toml", help="Instead of PART.toml."),
    ] = None,
) -> None:
    """Write a case file for a CAD part: bodies, interfaces, first materials, sizes; a picture."""
    from castx.command.check import draw_new_case
    from castx.domain.cad.new_case import write_new_case

    comm, console = output_of(context)
    target = cad_file.with_suffix(".toml") if output is None else output
    on_first_rank(comm, lambda: write_new_case(cad_file, target))
    console.print(f"written: {target}", markup=False)
    draw_new_case(target, comm, console)
    console.print(f"look into it, then: castx check {target}", markup=False)


@app.command()
def report(
    context: typer.Context,
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A results folder.")],
) -> None:
    """Write report.html, with curves and pictures, into a results folder."""
    from castx.report.report import write_report

    comm, console = output_of(context)
    if comm.rank == 0:
        console.print(f"written: {write_report(folder)}", markup=False)


@app.command()
def materials(
    context: typer.Context,
    name: Annotated[
        str | None, typer.Argument(metavar="[NAME]", help="Show all numbers of this one.")
    ] = None,
    case_file: Annotated[
        Path | None,
        typer.Option("--case", metavar="CASE.toml", help="Take the materials of a case too."),
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Draw NAME over temperature: .png, .svg or .pdf."),
    ] = None,
) -> None:
    """List the materials of the database, or the numbers of one with units, ranges and sources."""
    from castx.case.reading.read import load_case
    from castx.command.listing import material_list, material_table
    from castx.materials.lookup import find_material

    comm, console = output_of(context)
    case_materials = {} if case_file is None else load_case(case_file).materials
    if name is None:
        if plot is not None:
            raise typer.BadParameter("it draws one material: castx materials NAME --plot FILE")
        console.print(material_list(case_materials))
        console.refuse_loss()
        return
    console.print(material_table(name, case_materials))
    if plot is None:
        text = f"curves: castx materials {name} --plot {name}.png"
        console.print(text, markup=False)
        console.refuse_loss()
        return
    from castx.report.material_figure import write_figure

    material = find_material(name, case_materials)
    on_first_rank(comm, lambda: write_figure(material, plot))
    console.print(f"written: {plot}", markup=False)


@app.command()
def info(context: typer.Context) -> None:
    """Show the versions of castx and of what it runs on, and whether the BLAS is fast."""
    from castx.command.listing import version_table
    from castx.environment import blas_advantage, blas_warning

    _, console = output_of(context)
    console.print(version_table())
    console.print(blas_warning(blas_advantage()) or "the BLAS in use is fast", markup=False)
    console.refuse_loss()
