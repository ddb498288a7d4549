"""Runs beside a run: other cases of the same file, with results inside the folder of the run."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from castx.case.case import Case
from castx.command.run import RunSettings, run_case
from castx.errors import ConvergenceError
from castx.ranks import on_first_rank
from castx.results.files.folder import CHECKPOINT

TOO_SHORT = 1e-3
"""Time limit that is left at least, so that a run without time ends after a step [s]."""

log = logging.getLogger(__name__)


def run_beside(case: Case, others: Iterable[Case], settings: RunSettings) -> Path:
    """Run a case and others behind it, and return its results folder; collective.

    One of the others that does not converge is said, and stops nothing.

    Args:
        case: the case.
        others: with results folders of their own; each is asked for once those before have ended.
            They go on from checkpoints where they have one.
        settings: of all runs.

    Raises:
        CaseError, MeshError, ConvergenceError, StorageError, KeyboardInterrupt: as in `castx.run`.
    """
    begin = time.monotonic()
    comm, limit = settings.comm, settings.time_limit

    def for_next(restart: bool) -> RunSettings:
        if limit is None:
            return replace(settings, restart=restart)
        left = comm.bcast(limit - time.monotonic() + begin)
        return replace(settings, restart=restart, time_limit=max(left, TOO_SHORT))

    folder = run_case(case, for_next(settings.restart))
    for other in others:
        there = on_first_rank(comm, (other.output.folder / CHECKPOINT).is_dir)
        log.info("%s", other.output.folder.name)
        try:
            run_case(other, for_next(settings.restart and there))
        except ConvergenceError as error:
            log.warning("%s: not converged: %s", other.output.folder.name, error)
    return folder
