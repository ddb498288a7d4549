"""The cases of other programs on the command line: their list, their verdicts, their page."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

from mpi4py import MPI

from rich.box import SIMPLE_HEAD
from rich.table import Table

from castx.command.verify import Lines, known_messages_silent, list_or_verify
from castx.errors import ConvergenceError
from castx.proof.foreign.declaration import ForeignCase
from castx.proof.foreign.page import Ran, share_text, write_page
from castx.proof.foreign.registry import FOREIGN_CASES, chosen
from castx.ranks import on_first_rank


def compared(
    numbers: Sequence[str],
    folder: Path,
    comm: MPI.Intracomm,
    console: Lines,
    *,
    quick: bool,
    show: bool,
    foreign: bool,
) -> bool:
    """Compare castx with exact solutions or with other programs; return whether none is missed.

    Args:
        numbers: of what is compared; empty for all.
        folder: of the page.
        comm: the ranks.
        console: of the first rank.
        quick: take the coarser levels of exact solutions.
        show: list what there is and run none.
        foreign: whether the cases of other programs are meant.

    Raises:
        CaseError: a number is not known.
    """
    if foreign:
        return list_or_run(numbers, folder, comm, console, show=show)
    return list_or_verify(numbers, folder, comm, console, quick=quick, show=show)


def foreign_list() -> Table:
    """Return the table of all cases."""
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
    begin = time.perf_counter()
    with known_messages_silent():
        try:
            numbers, failure = case.run(comm), ""
        except ConvergenceError as error:
            numbers, failure = (), str(error)
    return Ran(case, numbers, comm.bcast(time.perf_counter() - begin), failure)


def verdict_text(ran: Ran) -> str:
    """Return a verdict in a line."""
    said = "met" if ran.met else "MISSED"
    if ran.worst is None:
        return f"{said}: {ran.failure}"
    worst = ran.worst
    return (
        f"{said}, {worst.name}: {share_text(worst.error)} of {share_text(worst.tolerance)}, "
        f"{ran.seconds:.1f} s"
    )
