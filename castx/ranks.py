"""The end of a command on several ranks: one exit code for all, and no rank left waiting."""

from __future__ import annotations

import sys
import time

from mpi4py import MPI

GRACE = 5.0
"""Time for the other ranks to end after one has failed [s]."""
PAUSE = 0.01
"""Time between two looks at the other ranks [s]."""
BUG = 1
"""Exit code of all ranks after a fault of castx itself."""


def common_code(verdicts: MPI.Intracomm, code: int) -> int:
    """Return the largest exit code of all ranks; collective.

    A rank that has failed waits for the others for a grace period and then ends them all with its
    code.

    Args:
        verdicts: the ranks, a communicator of its own.
        code: of this rank.
    """
    _await(verdicts, code, GRACE if code else float("inf"))
    return int(verdicts.allreduce(code, MPI.MAX))


def end_unless_all_failed(verdicts: MPI.Intracomm, why: object) -> None:
    """Wait until all ranks have failed, else abort them; collective for ranks that have failed.

    An error that is raised on some ranks only would leave the others waiting for ever.

    Args:
        verdicts: the ranks, a communicator of its own.
        why: the failure of this rank.
    """
    _await(verdicts, BUG, GRACE, f": {why}")


def _await(verdicts: MPI.Intracomm, code: int, patience: float, why: str = "") -> None:
    """Return when all ranks have arrived; abort them when that takes too long."""
    if verdicts.size == 1:
        return
    arrival = verdicts.Ibarrier()
    give_up = time.monotonic() + patience
    while not arrival.Test():
        time.sleep(PAUSE)
        if time.monotonic() > give_up:
            text = f"castx: rank {verdicts.rank} has failed alone and ends the others{why}\n"
            sys.stderr.write(text)
            sys.stderr.flush()
            verdicts.Abort(code)
