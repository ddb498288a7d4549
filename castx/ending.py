"""The end of a command on several ranks: one exit code for all, and no rank left waiting."""

from __future__ import annotations

import sys
import time

from mpi4py import MPI

GRACE = 5.0
"""Time in which the other ranks have to come to an end after one has failed [s]."""
PAUSE = 0.01


def common_code(verdicts: MPI.Intracomm, code: int) -> int:
    """Return the largest exit code of all ranks once all have come here; collective.

    A rank that has failed while others wait for it, or for ever, ends them all with its code.

    Args:
        verdicts: the ranks, a communicator of its own.
        code: of this rank.
    """
    if verdicts.size == 1:
        return code
    arrival = verdicts.Ibarrier()
    give_up = time.monotonic() + (GRACE if code else float("inf"))
    while not arrival.Test():
        time.sleep(PAUSE)
        if time.monotonic() > give_up:
            sys.stderr.write(f"castx: rank {verdicts.rank} has failed alone and ends the others\n")
            sys.stderr.flush()
            verdicts.Abort(code)
    return int(verdicts.allreduce(code, MPI.MAX))
