"""Console and messages of castx: rank 0 only, no colours where output is no terminal, enduring."""

from __future__ import annotations

import logging
import os
import signal
import threading
from collections.abc import Sequence
from contextlib import suppress
from enum import StrEnum
from typing import Any

from mpi4py import MPI

import typer
from rich.console import Console
from rich.logging import RichHandler

from castx.errors import StorageError
from castx.input.printable import printable

LINES = "\n\t"
"""Control characters of castx's own texts."""


class EnduringConsole(Console):
    """A console that drops what its reader or its disk no longer takes, and goes on.

    Texts are shown without characters that a terminal would obey.

    Attributes:
        failure: why it has dropped something, in the words of the system; "" as long as all is
            written or its reader has left on purpose.
    """

    failure = ""

    def print(self, *objects: Any, **options: Any) -> None:
        """Print objects as rich does."""
        shown = [printable(o, LINES) if isinstance(o, str) else o for o in objects]
        try:
            super().print(*shown, **options)
        except OSError as error:
            self.failure = error.strerror or str(error)
            self._close()

    def on_broken_pipe(self) -> None:
        """Drop all further output; rich would end the process."""
        self._close()

    def _close(self) -> None:
        self.quiet = True
        with suppress(OSError, ValueError):  # a stream without a file behind it
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self.file.fileno())  # Python writes what is left at its end
            os.close(nowhere)

    def refuse_loss(self) -> None:
        """Say so where the text itself was asked for and could not be written.

        Raises:
            StorageError: on the rank that writes; nothing collective may follow.
        """
        if self.failure:
            raise StorageError(f"the output cannot be written: {self.failure}")


def console_of(comm: MPI.Intracomm, *, stderr: bool = False) -> EnduringConsole:
    """Return a console that is silent on all ranks but the first.

    Under mpirun the output of rank 0 is a pseudo-terminal even when mpirun writes into a file, so
    that nothing there is taken for a terminal.
    """
    launched = comm.size > 1 or "PMIX_RANK" in os.environ
    return EnduringConsole(
        stderr=stderr,
        quiet=comm.rank != 0,
        soft_wrap=True,
        highlight=False,
        force_terminal=False if launched else None,
    )


def endure_broken_pipes() -> None:
    """Let writing to a reader that has left fail instead of killing the process, as Python does.

    PETSc takes that signal when it is loaded, and ends all ranks.
    """
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGPIPE, signal.SIG_IGN)


class Detail(StrEnum):
    """A part of the solution of which a run can show every iteration."""

    NEWTON = "newton"

    @property
    def modules(self) -> tuple[str, ...]:
        """Names of the loggers."""
        return {Detail.NEWTON: ("castx.process.simulation", "castx.solvers.snes")}[self]


class VariedNumber(StrEnum):
    """A number with which a run can be repeated, a little lower and higher."""

    COHERENCY = "coherency"


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
