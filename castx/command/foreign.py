"""The command `castx verify`, and on it the cases of other programs: list, verdicts, page."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from mpi4py import MPI

import typer
from rich.box import SIMPLE_HEAD
from rich.table import Table

from castx.command.terminal import output_of
from castx.errors import ConvergenceError
from castx.ranks import on_first_rank

if TYPE_CHECKING:  # solvers and pictures, which other commands do without
    from castx.command.verify import Lines
    from castx.proof.foreign.declaration import ForeignCase
    from castx.proof.foreign.page import Ran

MISSED = 1
"""Exit code where a tolerance is missed."""


def verify(
    context: typer.Context,
    numbers: Annotated[list[str] | None, typer.Argument(metavar="[V1 …]", help="These.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Coarser meshes: minutes.")] = False,
    show_list: Annotated[bool, typer.Option("--list", help="List them and run none.")] = False,
    foreign: Annotated[bool, typer.Option("--foreign", help="Cases of other programs.")] = False,
    output: Annotated[Path, typer.Option(metavar="DIR")] = Path("results/verification"),
) -> None:
    """Compare castx with exact solutions and write a page; fails if a tolerance is missed."""
    from castx.command.verify import list_or_verify

    comm, console = output_of(context)
    met = (
        list_or_run(numbers or (), output, comm, console, show=show_list)
        if foreign
        else list_or_verify(numbers or (), output, comm, console, quick=quick, show=show_list)
    )
    if not met:
        raise typer.Exit(MISSED)


def foreign_list() -> Table:
    """Return the table of all cases."""
    from castx.proof.foreign.registry import FOREIGN_CASES

    table = Table("", "case", "program", "path", box=SIMPLE_HEAD, pad_edge=False)
    for number, case in FOREIGN_CASES.items():
        table.add_row(number, case.title, case.program, case.path)
    return table


def list_or_run(
    numbers: Sequence[str], folder: Path, comm: MPI.Intracomm, console: Lines, *, show: bool
) -> bool:
    """List all cases, or run some and write the page; return whether none is missed.

    Args:
        numbers: of those to run, such as "X3"; empty for all.
        folder: of the page.
        comm: the ranks.
        console: of the first rank.
        show: list them and run none.

    Raises:
        CaseError: a number is not known.
    """
    from castx.proof.foreign.page import write_page
    from castx.proof.foreign.registry import chosen

    if show:
        console.print(foreign_list())
        console.refuse_loss()
        return True
    found = []
    for case in chosen(numbers):
        console.print(f"{case.number:4}{case.title} ({case.program}) …", markup=False, end=" ")
        found.append(run_case(case, comm))
        console.print(verdict_text(found[-1]), markup=False)
    page = on_first_rank(comm, lambda: write_page(folder, found, comm.size))
    missed = [one.case.number for one in found if not one.met]
    result = f"missed: {', '.join(missed)}" if missed else "all met"
    seconds = sum(one.seconds for one in found)
    console.print(f"{len(found)} cases of other programs, {result}, {seconds:.0f} s", markup=False)
    console.print(f"written: {page}", markup=False)
    return not missed


def run_case(case: ForeignCase, comm: MPI.Intracomm) -> Ran:
    """Run a case and return its numbers, or why it has none; collective."""
    from castx.command.verify import known_messages_silent
    from castx.proof.foreign.page import Ran

    begin = time.perf_counter()
    with known_messages_silent():
        try:
            numbers, failure = case.run(comm), ""
        except ConvergenceError as error:
            numbers, failure = (), str(error)
    return Ran(case, numbers, comm.bcast(time.perf_counter() - begin), failure)


def verdict_text(ran: Ran) -> str:
    """Return a verdict in a line."""
    from castx.proof.foreign.page import share_text

    said = "met" if ran.met else "MISSED"
    if ran.worst is None:
        return f"{said}: {ran.failure}"
    worst = ran.worst
    return (
        f"{said}, {worst.name}: {share_text(worst.error)} of {share_text(worst.tolerance)}, "
        f"{ran.seconds:.1f} s"
    )
