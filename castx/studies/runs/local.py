"""Runs as processes of this machine, some at once, each on one core and with limited memory."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass

from castx.input.child_process import environment_of_no_rank, shortened
from castx.studies.runs.executor import Ended, Task

PATIENCE = 0.02
"""Time between two looks at the processes [s]."""
AT_THE_END = 10.0
"""Time in which a process that is asked to stop may write its checkpoint [s]."""
ONE_THREAD = {name: "1" for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")}


def cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0))


@dataclass(frozen=True)
class LocalProcesses:
    """Executor of processes on this machine.

    Attributes:
        processes: at once; None: one for each core.
        memory: that each may take [byte]; None: no limit.
    """

    processes: int | None = None
    memory: float | None = None

    def ended(self, tasks: Sequence[Task]) -> Iterator[tuple[int, Ended]]:
        """Yield the ends of tasks; see `Executor`."""
        waiting = list(enumerate(tasks))[::-1]
        most = self.processes or cores()
        going: dict[int, tuple[subprocess.Popen[bytes], float]] = {}
        try:
            while waiting or going:
                while waiting and len(going) < most:
                    index, task = waiting.pop()
                    going[index] = self._started(task), time.monotonic()
                done = {
                    index: took
                    for index, (process, _) in going.items()
                    if (took := processor_seconds(process)) is not None
                }
                for index, took in done.items():
                    process, start = going.pop(index)
                    passed = time.monotonic() - start
                    said = words_at_the_end(tasks[index], process.returncode)
                    yield index, Ended(process.returncode, said, passed, took)
                if not done:
                    time.sleep(PATIENCE)
        finally:
            stop([process for process, _ in going.values()])

    def _started(self, task: Task) -> subprocess.Popen[bytes]:
        with task.log.open("wb") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", "castx", *task.arguments],
                stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                env=environment_of_no_rank() | ONE_THREAD, start_new_session=True,
            )  # fmt: skip
        if self.memory is not None:
            with suppress(ProcessLookupError):  # it has ended already
                limit = int(self.memory)
                resource.prlimit(process.pid, resource.RLIMIT_DATA, (limit, limit))
        return process


def processor_seconds(process: subprocess.Popen[bytes]) -> float | None:
    """Return the time of processors that a process took with its own children [s].

    The system adds it to that of all children when the end of a process is asked for.

    Returns:
        None as long as it goes on.
    """
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    if process.poll() is None:
        return None
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def stop(processes: Sequence[subprocess.Popen[bytes]]) -> None:
    """Ask processes to stop, and end those that do not."""
    for process in processes:
        process.terminate()
    end = time.monotonic() + AT_THE_END
    for process in processes:
        try:
            process.wait(max(0.0, end - time.monotonic()))
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def words_at_the_end(task: Task, code: int) -> str:
    """Return the last words of a run, or the signal that ended it before it could say any.

    Args:
        task: the run.
        code: its exit code, negative for a signal.
    """
    if code >= 0:
        return last_words(task)
    said = f"ended by {signal.Signals(-code).name}"
    if code == -signal.SIGKILL:
        said += ", as is done with programs for which the memory does not suffice"
    return said


def last_words(task: Task) -> str:
    """Return the refusal or failure that castx has told last, else its last line."""
    lines = task.log.read_text(encoding="utf-8", errors="replace").splitlines()
    lines = [line.strip() for line in lines if line.strip()]
    named = [line for line in lines if line.startswith("castx: ")]
    return shortened((named or lines or ["no word"])[-1]).removeprefix("castx: ")
