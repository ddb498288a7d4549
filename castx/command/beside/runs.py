"""Runs beside a run: other cases of the same file, with results inside the folder of the run."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterable
from pathlib import Path

from mpi4py import MPI

from castx.case.case import Case
from castx.command.run import run_case
from castx.errors import ConvergenceError
from castx.ranks import on_first_rank
from castx.results.files.folder import CHECKPOINT
from castx.results.files.run_tables import RunTables

TOO_SHORT = 1e-3
"""Time limit that is left at least, so that a run without time ends after a step [s]."""

log = logging.getLogger(__name__)


def run_beside(
    case: Case,
    others: Iterable[Case],
    comm: MPI.Intracomm,
    restart: bool = False,
    time_limit: float | None = None,
    profile: bool = False,
) -> Path:
    """Run a case and others behind it, and return its results folder; collective.

    One of the others that does not converge is said, and stops nothing.

    Args:
        case: the case.
        others: with results folders of their own; each is asked for once those before have ended.
        comm: the ranks to run on.
        restart: go on from the checkpoints, of the others where they have one.
        time_limit: wall clock time of all runs together [s].
        profile: write into run.json what the parts of each run have cost.

    Raises:
        CaseError, MeshError, ConvergenceError, StorageError, KeyboardInterrupt: as in `castx.run`.
    """
    begin = time.monotonic()

    def left() -> float | None:
        return None if time_limit is None else max(
            comm.bcast(time_limit - time.monotonic() + begin), TOO_SHORT
        )  # fmt: skip

    folder = run_case(case, comm, restart, left(), profile)
    for other in others:
        there = on_first_rank(comm, (other.output.folder / CHECKPOINT).is_dir)
        log.info("%s", other.output.folder.name)
        try:
            run_case(other, comm, restart and there, left(), profile)
        except ConvergenceError as error:
            log.warning("%s: not converged: %s", other.output.folder.name, error)
    return folder


def cells_of_all(run: RunTables) -> int:
    """Return the number of cells of all bodies of a run."""
    return sum(int(body["cells"]) for body in run.record["bodies"].values())
