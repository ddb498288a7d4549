"""The console of castx: rank 0 only, and without colours where output is no terminal."""

from __future__ import annotations

import os

from mpi4py import MPI

from rich.console import Console


def console_of(comm: MPI.Intracomm, *, stderr: bool = False) -> Console:
    """Return a console that is silent on all ranks but the first.

    Under mpirun the output of rank 0 is a pseudo-terminal even when mpirun writes into a file, so
    that nothing there is taken for a terminal.
    """
    launched = comm.size > 1 or "PMIX_RANK" in os.environ
    return Console(
        stderr=stderr,
        quiet=comm.rank != 0,
        soft_wrap=True,
        highlight=False,
        force_terminal=False if launched else None,
    )
