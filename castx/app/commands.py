"""Commands of castx as processes of their own, one at a time: what they say, their stop."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from castx.errors import CaseError
from castx.input.child_process import environment_of_no_rank

KEPT = 2000
"""Lines of a command that are kept."""
LONGEST = 2000
"""Characters of a line that are kept."""
OF_A_PAGE = {"NO_COLOR": "1", "PYTHONUNBUFFERED": "1"}
"""Variables by which its output suits the page."""
COLUMNS = range(60, 201)
"""Letters that a line of its output may have."""


class Command:
    """A command of castx that runs, or has run.

    Args:
        arguments: behind `castx`.
        folder: in which it runs.
        columns: letters of a line of its output, as far as COLUMNS goes.
    """

    def __init__(self, arguments: Sequence[str], folder: Path, columns: int) -> None:
        self.arguments = tuple(arguments)
        width = min(max(columns, COLUMNS[0]), COLUMNS[-1])
        # A session of its own: Ctrl-C is the server's, which tells the command to stop.
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "castx", *arguments], cwd=folder,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            env=environment_of_no_rank() | OF_A_PAGE | {"COLUMNS": str(width)},
            start_new_session=True, text=True, errors="replace",
        )  # fmt: skip
        self._lines: deque[str] = deque(maxlen=KEPT)
        self._said = 0
        self._told = False
        self._lock = threading.Lock()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self._process.stdout is not None
        with self._process.stdout as said:
            for line in said:
                with self._lock:
                    self._lines.append(line.rstrip()[:LONGEST])
                    self._said += 1

    @property
    def text(self) -> str:
        """The command as one types it."""
        return shlex.join(["castx", *self.arguments])

    @property
    def ended(self) -> bool:
        """Whether it has ended and all is read that it has said."""
        return self._process.poll() is not None and not self._reader.is_alive()

    @property
    def code(self) -> int | None:
        """Its exit code; None: it runs."""
        return self._process.poll() if self.ended else None

    def state(self, since: int = 0) -> dict[str, Any]:
        """Return its state and its new lines, for JSON.

        Args:
            since: lines that the page has already.
        """
        ended = self.ended  # before the lines, so that the last ones are among them
        with self._lock:
            first = self._said - len(self._lines)
            lines = list(self._lines)[max(since - first, 0) :]
            said = self._said
        return {
            "text": self.text, "name": self.arguments[0], "ended": ended,
            "code": self._process.poll() if ended else None, "stopping": self._told,
            "lines": lines, "said": said,
        }  # fmt: skip

    def stop(self) -> None:
        """End the command early: a run ends after its step, and its state is on disk."""
        if self._process.poll() is None:
            self._told = True
            if self.arguments[0] == "run":
                self._process.send_signal(signal.SIGTERM)
            else:  # with the processes that it has started, such as a mesher
                os.killpg(self._process.pid, signal.SIGTERM)

    def kill(self) -> None:
        """End it at once; of a run the last checkpoint stays."""
        if self._process.poll() is None:
            os.killpg(self._process.pid, signal.SIGKILL)

    def wait(self, seconds: float | None = None) -> bool:
        """Wait until it has ended, and return whether it has."""
        end = None if seconds is None else time.monotonic() + seconds
        while not self.ended:
            if end is not None and time.monotonic() > end:
                return False
            time.sleep(0.05)
        return True


class Commands:
    """The command of a page, one at a time.

    Args:
        folder: in which they run.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._lock = threading.Lock()
        self.last: Command | None = None

    def start(self, arguments: Sequence[str], columns: int) -> Command:
        """Start a command.

        Args:
            arguments: behind `castx`.
            columns: letters of a line of its output.

        Raises:
            CaseError: another one runs.
        """
        with self._lock:
            if self.last is not None and not self.last.ended:
                raise CaseError(f"{self.last.text} still runs: wait for it, or stop it first")
            self.last = Command(arguments, self._folder, columns)
            return self.last
