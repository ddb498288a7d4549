"""Refusals that several commands have in common."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from mpi4py import MPI

from castx.errors import CaseError, MeshError


def seconds(option: str, text: str) -> float:
    """Return the value of an option that is a time [s].

    Args:
        option: its name, for the message.
        text: a number of seconds, or one with a unit.

    Raises:
        CaseError: it is none.
    """
    from castx.input.entries import Quantity  # takes half of the time of --help
    from castx.input.units import TIME

    try:
        value: str | float = float(text)
    except ValueError:
        value = text
    try:
        return Quantity(TIME, above=0.0).read(value)
    except CaseError as error:
        raise CaseError(f'{option} {text}: {error}; for instance "8 h"') from None


def on_first_rank(comm: MPI.Intracomm, action: Callable[[], None]) -> None:
    """Do something on rank 0 and raise its refusal on all ranks; collective.

    Args:
        comm: the ranks.
        action: what rank 0 does.

    Raises:
        CaseError, MeshError: what the action has raised.
    """
    refusal: CaseError | MeshError | None = None
    if comm.rank == 0:
        try:
            action()
        except (CaseError, MeshError) as error:
            refusal = error
    if (refusal := comm.bcast(refusal)) is not None:
        raise refusal


@contextmanager
def naming(case_file: Path) -> Iterator[None]:
    """Name the case file in front of refusals that do not name it."""
    try:
        yield
    except (CaseError, MeshError) as error:
        if str(case_file) in str(error):
            raise
        kind = CaseError if isinstance(error, CaseError) else MeshError
        raise kind(f"{case_file}: {error}") from error
