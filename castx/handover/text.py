"""Texts of files that other programs read."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy.typing as npt

from castx.errors import CaseError

NEGLIGIBLE = 1e-99
"""Size below which a number is written as zero: its exponent would have three digits."""


def digits(value: float) -> str:
    """Return a number in 14 digits and at most 20 characters, the limit of CalculiX.

    It would read -1.30702915157599e-09 as -1.30702915157599e-0.
    """
    return f"{0.0 if abs(value) < NEGLIGIBLE else value:.14g}"


def row(values: Iterable[float]) -> str:
    """Return numbers divided by commas, each as `digits` writes it."""
    return ", ".join(map(digits, values))


def listed(values: npt.NDArray[Any]) -> Any:
    """Return an array as nested lists of plain numbers, which are faster to write singly."""
    return values.tolist()


def write_lines(path: Path, lines: Iterable[str]) -> None:
    """Write lines into a file, whose folder is made.

    Raises:
        CaseError: the disk does not take it.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("w") as file:
            for line in lines:
                file.write(line + "\n")
    except OSError as error:
        raise CaseError(f"cannot write {path}: {error.strerror}") from error
