"""What makes the runs of a study: processes of this machine, or anything that offers the same."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol


@dataclass(frozen=True)
class Task:
    """One run of castx.

    Attributes:
        arguments: of the command `castx`.
        log: a file for what it says, in a folder that exists.
    """

    arguments: tuple[str, ...]
    log: Path


@dataclass(frozen=True)
class Ended:
    """How a run has ended.

    Attributes:
        code: exit code of castx, negative for a signal that ended it.
        said: its last words.
        seconds: wall clock time that it took [s].
        processor_seconds: time of processors that it took [s].
    """

    code: int
    said: str
    seconds: float
    processor_seconds: float


class Executor(Protocol):
    """Makes runs, some of them at once."""

    def ended(self, tasks: Sequence[Task]) -> Iterator[tuple[int, Ended]]:
        """Yield the index of each task, and how it has ended, in the order in which they end.

        When the iteration is given up, no run of it goes on.
        """
        ...
