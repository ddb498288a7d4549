"""Several ranks as one: work and refusals of the first, one exit code, no rank left waiting."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TypeVar, cast

from mpi4py import MPI

from castx.errors import CaseError, MeshError

T = TypeVar("T")

GRACE = 5.0
"""Time for the other ranks to end after one has failed [s]."""
PAUSE = 0.01
"""Time between two looks at the other ranks [s]."""
BUG = 1
"""Exit code of all ranks after a fault of castx itself."""


def on_first_rank(comm: MPI.Intracomm, action: Callable[[], T]) -> T:
    """Do something on rank 0 and return its result, or raise its refusal, on all ranks; collective.

    Args:
        comm: the ranks.
        action: what rank 0 does.

    Raises:
        CaseError, MeshError: what the action has raised.
    """
    found: T | None = None
    refusal: CaseError | MeshError | None = None
    if comm.rank == 0:
        try:
            found = action()
        except (CaseError, MeshError) as error:
            refusal = error
    found, refusal = comm.bcast((found, refusal))
    if refusal is not None:
        raise refusal
    return cast(T, found)


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
