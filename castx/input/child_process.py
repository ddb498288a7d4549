"""Processes of their own for files that may crash, stop or exhaust the library that reads them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from typing import IO

from castx.input.printable import printable

REFUSED = 3
"""Exit code of a child after a refusal in words."""
SHOWN = 300
"""Characters of what a child has said that are shown."""
OF_MPI = ("OMPI_", "PMIX_", "PRTE_", "PMI_")
"""Beginnings of the variables by which a process takes itself for a rank."""


def environment_of_no_rank() -> dict[str, str]:
    """Return the variables of this process for a child that is no rank of this run."""
    return {key: value for key, value in os.environ.items() if not key.startswith(OF_MPI)}


def run_apart(
    arguments: Sequence[str],
    patience: float,
    *,
    given: IO[bytes] | int = subprocess.DEVNULL,
    errors: int = subprocess.PIPE,
) -> subprocess.CompletedProcess[bytes]:
    """Run Python in a process that is no rank of this run, and return what it has written.

    Args:
        arguments: of Python: a script or a module, and its own arguments.
        patience: time that it may take [s].
        given: an open file that it reads as its standard input; no pipe, since PETSc ends a process
            that writes to a reader which has died.
        errors: `subprocess.STDOUT` puts its standard error among its standard output.

    Raises:
        TimeoutExpired: it took longer, and was killed.
    """
    return subprocess.run(
        [sys.executable, "-P", *arguments],
        stdin=given, stdout=subprocess.PIPE, stderr=errors, timeout=patience, check=False,
        env=environment_of_no_rank() | {"OPENBLAS_NUM_THREADS": "1"},
    )  # fmt: skip


def end_of(who: str, code: int, said: bytes) -> str:
    """Return a text on the end of a child that has not answered.

    Args:
        who: what it is, such as "reader".
        code: its exit code, negative for a signal.
        said: what it has written beside its answer.
    """
    lines = [line for line in said.decode(errors="replace").splitlines() if line.strip()]
    last = shortened(lines[-1]) if lines else "no word"
    how = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
    return f"its {who} ended {how} ({last})"


def shortened(text: str) -> str:
    """Return a text of a child as one line of limited length."""
    line = printable(text.replace("\n", " "))
    return line if len(line) <= SHOWN else f"{line[:SHOWN]} ..."
