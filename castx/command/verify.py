"""The verifications on the command line: their list, their verdicts, their page."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

from mpi4py import MPI

from rich.box import SIMPLE_HEAD
from rich.table import Table

from castx.proof.verification.page import error_text, order_text, write_page
from castx.proof.verification.registry import VERIFICATIONS, chosen
from castx.proof.verification.verdict import Verdict, verified
from castx.ranks import on_first_rank


class Lines(Protocol):
    """A console as the command line has it."""

    def print(self, *objects: Any, **options: Any) -> None:
        """Print objects as rich does."""

    def refuse_loss(self) -> None:
        """Raise StorageError if something was dropped."""


def verification_list() -> Table:
    """Return the table of all verifications."""
    table = Table("", "verification", "source", box=SIMPLE_HEAD, pad_edge=False)
    for number, verification in VERIFICATIONS.items():
        table.add_row(number, verification.title, verification.source)
    return table


def list_or_verify(
    numbers: Sequence[str],
    folder: Path,
    comm: MPI.Intracomm,
    console: Lines,
    *,
    quick: bool,
    show: bool,
) -> bool:
    """List all verifications, or run them as `verify` does; return whether none is missed."""
    if not show:
        return verify(numbers, folder, comm, console, quick=quick)
    console.print(verification_list())
    console.refuse_loss()
    return True


def verify(
    numbers: Sequence[str], folder: Path, comm: MPI.Intracomm, console: Lines, *, quick: bool
) -> bool:
    """Run verifications, show each verdict, write the page, and return whether all are met.

    Args:
        numbers: of those to run, such as "V3"; empty for all.
        folder: of the page.
        comm: the ranks.
        console: of the first rank.
        quick: take the coarser levels.

    Raises:
        CaseError: a number is not known.
    """
    verdicts = []
    for verification in chosen(numbers):
        console.print(f"{verification.number:4}{verification.title} …", markup=False, end=" ")
        with known_messages_silent():
            verdicts.append(verified(verification, comm, quick=quick))
        console.print(verdict_text(verdicts[-1]), markup=False)
    page = on_first_rank(
        comm, lambda: write_page(folder, verdicts, quick=quick, ranks=comm.size)
    )
    missed = [verdict.verification.number for verdict in verdicts if not verdict.met]
    seconds = sum(verdict.seconds for verdict in verdicts)
    result = f"missed: {', '.join(missed)}" if missed else "all met"
    console.print(f"{len(verdicts)} verifications, {result}, {seconds:.0f} s", markup=False)
    console.print(f"written: {page}", markup=False)
    return not missed


@contextmanager
def known_messages_silent() -> Iterator[None]:
    """Leave out, inside, what castx says of each case of its own, and why it is as it is."""
    levels = {"castx": logging.WARNING, "castx.process.building": logging.ERROR}
    before = {name: logging.getLogger(name).level for name in levels}
    for name, level in levels.items():
        logging.getLogger(name).setLevel(level)
    try:
        yield
    finally:
        for name, level in before.items():
            logging.getLogger(name).setLevel(level)


def verdict_text(verdict: Verdict) -> str:
    """Return a verdict in a line."""
    said = "met" if verdict.met else "MISSED"
    if verdict.failure or verdict.worst is None:
        return f"{said}: {verdict.failure}"
    worst = verdict.worst
    text = (
        f"{said}, {worst.name} {error_text(worst.error, worst)} of "
        f"{error_text(worst.tolerance * verdict.allowance, worst)}"
    )
    if verdict.order is not None:
        text += f", order {order_text(verdict.order)}"
    return f"{text}, {verdict.seconds:.1f} s"
