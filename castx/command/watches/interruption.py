"""Interruption of a run by signals or a time limit, on all ranks together and between two tries."""

from __future__ import annotations

import logging
import signal
import threading
import time
from collections import deque
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import Any, Self

from mpi4py import MPI

from castx.errors import Interrupted
from castx.signals import STOPPED

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1)
"""SIGHUP comes when a terminal is closed; SIGUSR1 is what mpirun hands on without killing its ranks
and what queues send some time before their end."""
PATIENCE = 1.0
"""Time after the first signal in which others count as the same request [s]."""
REMEMBERED = 5
"""Tries from which the time of the next one is estimated."""

log = logging.getLogger(__name__)


class Interruption:
    """Raises `Interrupted` on all ranks after a try when a signal came or the time is up.

    A signal may reach one rank only, in the middle of a solve in which the others wait for it.
    Asked again with Ctrl-C more than a second later, the run stops at once.

    Attributes:
        at_once: called when the first signal arrives; must be local, quick and harmless anywhere,
            since mpirun kills its ranks a quarter of a second later.

    Args:
        comm: the ranks that stop together.
        time_limit: wall clock time from now before which to stop [s]; one try is always made.
    """

    def __init__(self, comm: MPI.Intracomm, time_limit: float | None = None) -> None:
        self.at_once: Callable[[], None] = lambda: None
        self._comm = comm
        self._since: float | None = None
        self._replaced: dict[int, Any] = {}
        self._limit, self._began = time_limit, time.monotonic()
        self._last = self._began
        self._tries: deque[float] = deque(maxlen=REMEMBERED)

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            for number in SIGNALS:
                if number == signal.SIGHUP and signal.getsignal(number) == signal.SIG_IGN:
                    continue  # nohup
                self._replaced[number] = signal.signal(number, self._note)
            # PETSc would end all ranks when the reader of the output leaves.
            self._replaced[signal.SIGPIPE] = signal.signal(signal.SIGPIPE, signal.SIG_IGN)
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
            self.at_once()
        elif number == signal.SIGINT and now - self._since > PATIENCE:
            if self._comm.size > 1:
                self._comm.Abort(130)
            raise KeyboardInterrupt

    def check(self) -> None:
        """Raise `Interrupted` on all ranks if any of them received a signal; collective.

        Raises:
            Interrupted: says why.
        """
        self._last = time.monotonic()
        if self._comm.allreduce(self._since is not None, MPI.LOR):
            raise Interrupted(STOPPED)

    def after_try(self) -> None:
        """Raise `Interrupted` after a try also if the time limit allows no other one; collective.

        Raises:
            Interrupted: says why.
        """
        before = self._last
        self.check()
        self._tries.append(self._last - before)
        if self._limit is None:
            return
        late = self._last - self._began + max(self._tries) > self._limit
        if self._comm.allreduce(late, MPI.LOR):
            raise Interrupted(f"the time limit of {self._limit:g} s leaves no time for a step")
