"""Refusals that several commands have in common."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

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
