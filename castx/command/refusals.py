"""What the commands refuse in the same way."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from mpi4py import MPI

from castx.errors import CaseError, MeshError
from castx.input.entries import Quantity
from castx.input.units import TIME


def seconds(option: str, text: str) -> float:
    """Return the value of an option that is a time.

    Raises:
        CaseError: it is none.
    """
    try:
        value: str | float = float(text)
    except ValueError:
        value = text
    try:
        return Quantity(TIME, above=0.0).read(value)
    except CaseError as error:
        raise CaseError(f'{option} {text}: {error}; for instance "8 h"') from None


def on_first_rank(comm: MPI.Intracomm, action: Callable[[], None]) -> None:
    """Do something on rank 0, and raise on all ranks what it refuses."""
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
    """Put the case file in front of refusals that do not name it."""
    try:
        yield
    except (CaseError, MeshError) as error:
        if str(case_file) in str(error):
            raise
        kind = CaseError if isinstance(error, CaseError) else MeshError
        raise kind(f"{case_file}: {error}") from error
