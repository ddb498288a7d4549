"""The end of a command on several ranks: one exit code for all, and no rank left waiting."""

from __future__ import annotations

import sys
import time

from mpi4py import MPI

GRACE = 5.0
"""Time in which the other ranks have to come to an end after one has failed [s]."""
PAUSE = 0.01
BUG = 1
"""Exit code of all ranks when one has failed that should not have."""


def common_code(verdicts: MPI.Intracomm, code: int) -> int:
    """Return the largest exit code of all ranks once all have come here; collective.

    A rank that has failed while others wait for it, or for ever, ends them all with its code.

    Args:
        verdicts: the ranks, a communicator of its own.
        code: of this rank.
    """
    _await(verdicts, code, GRACE if code else float("inf"))
    return int(verdicts.allreduce(code, MPI.MAX))


def end_unless_all_failed(verdicts: MPI.Intracomm, why: object) -> None:
    """Wait for the others to fail too; collective for those that have failed.

    What should be raised on all ranks or none could otherwise leave the others waiting for ever.
    A rank that stays alone ends them all.

    Args:
        verdicts: the ranks, a communicator of its own.
        why: what has failed here.
    """
    _await(verdicts, BUG, GRACE, f": {why}")


def _await(verdicts: MPI.Intracomm, code: int, patience: float, why: str = "") -> None:
    """Return when all ranks have come here; end them when that takes too long."""
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
