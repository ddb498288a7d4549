"""Stopping a run from outside: all ranks together, between two steps, with their files finished."""

from __future__ import annotations

import logging
import signal
import threading
import time
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import Any, Self

from mpi4py import MPI

SIGNALS = (signal.SIGINT, signal.SIGTERM)
PATIENCE = 1.0
"""Time after the first signal in which others count as the same request [s]."""

log = logging.getLogger(__name__)


class Interruption:
    """Turns Ctrl-C and SIGTERM into a KeyboardInterrupt raised on all ranks after the step.

    A signal may reach one rank only, in the middle of a solve in which the others wait for it.
    Asked again with Ctrl-C more than a second later, the run stops at once.

    Args:
        comm: the ranks that stop together.
        at_once: called when the first signal arrives; must be local, quick and harmless anywhere,
            since mpirun kills its ranks a quarter of a second later.
    """

    def __init__(self, comm: MPI.Intracomm, at_once: Callable[[], None]) -> None:
        self._comm = comm
        self._at_once = at_once
        self._since: float | None = None
        self._replaced: dict[int, Any] = {}

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            self._replaced = {number: signal.signal(number, self._note) for number in SIGNALS}
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for number, handler in self._replaced.items():
            signal.signal(number, handler)

    def _note(self, number: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        if self._since is None:
            self._since = now
            log.warning("interrupted: stopping after this step; Ctrl-C again to stop at once")
            self._at_once()
        elif number == signal.SIGINT and now - self._since > PATIENCE:
            if self._comm.size > 1:
                self._comm.Abort(130)
            raise KeyboardInterrupt

    def check(self) -> None:
        """Raise KeyboardInterrupt on all ranks when any of them was asked to stop; collective."""
        if self._comm.allreduce(self._since is not None, MPI.LOR):
            raise KeyboardInterrupt("stopped by a signal")
