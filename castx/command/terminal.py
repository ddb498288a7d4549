"""The console of castx: rank 0 only, without colours where output is no terminal, and enduring."""

from __future__ import annotations

import os
import signal
import threading
from contextlib import suppress
from typing import Any

from mpi4py import MPI

from rich.console import Console

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
        """Drop what follows; rich would end the process."""
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
