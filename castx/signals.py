"""Signals that ask a process to end, which PETSc takes to itself while it is imported."""

from __future__ import annotations

import signal
import threading

ENDING = (signal.SIGHUP, signal.SIGTERM)
"""Signals of a closed terminal and of a queue; for PETSc faults that abort all ranks with code 59,
even where `nohup` has had the first one ignored."""
STOPPED = "stopped by a signal"
"""What a run says that has ended by one of them."""


def hand_back() -> None:
    """Let signals that ask for the end do again what Python knows of them.

    Threads other than the main one may change nothing about signals: there they stay as they are.
    """
    if threading.current_thread() is threading.main_thread():
        for number in ENDING:
            signal.signal(number, signal.getsignal(number) or signal.SIG_DFL)
