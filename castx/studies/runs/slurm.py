"""Runs as an array of jobs of Slurm, each on one core of a cluster, by the package submitit."""

from __future__ import annotations

import os
import re
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from importlib.util import find_spec
from math import ceil
from pathlib import Path
from typing import Any

from castx.errors import CaseError
from castx.input.child_process import shortened
from castx.signals import STOPPED
from castx.studies.asked.slurm import SlurmJobs
from castx.studies.runs.executor import Ended, Task
from castx.studies.runs.local import LocalProcesses

PACKAGE, JOBS = "submitit", "jobs"
"""What hands runs to Slurm, and the folder of a study for what both write."""
PATIENCE, LOOKS = 1.0, 60.0
"""Time between two looks at the results of jobs, and at the queue of Slurm [s]."""
ANSWER = 30.0
"""Time in which Slurm has to say what waits [s]."""
MOST_AT_ONCE = 256
LOST, INTERRUPTED = -1, 130
"""Exit codes of a run whose job has brought nothing, and of one that was stopped."""
OUT_OF_ITS_TIME = "timed-out"
"""Word of submitit for that."""
TO_STOP = 30
"""Time that a run has for its end before Slurm ends its job [s]."""
NAMED_ERROR = re.compile(r"[\w.]*Error: ")
_MINUTE, _MEGABYTE = 60.0, 1e6


@dataclass(frozen=True)
class SlurmArrays:
    """Executor of jobs on a cluster.

    The folder of the study and castx itself must be seen from the nodes under the same paths.

    Attributes:
        jobs: settings of the jobs.
        folder: for what Slurm and submitit write.
        at_once: jobs that run at the same time; None: as many as Slurm lets run.
        memory: that each may take [byte]; None: that of the partition.
    """

    jobs: SlurmJobs
    folder: Path
    at_once: int | None = None
    memory: float | None = None

    def ended(self, tasks: Sequence[Task]) -> Iterator[tuple[int, Ended]]:
        """Yield the ends of tasks; see `Executor`.

        Raises:
            CaseError: submitit or Slurm is missing, or Slurm takes no such jobs.
        """
        if not tasks:
            return
        self._cancel_left()
        waiting = dict(enumerate(self._submitted(tasks)))
        absences = Absences()
        try:
            while waiting:
                renew(self.folder)
                done = [i for i, job in waiting.items() if job.paths.result_pickle.exists()]
                lost = [] if done else absences.lost({i: job.job_id for i, job in waiting.items()})
                for index in done:
                    yield index, end_of_job(waiting.pop(index))
                for index in lost:
                    yield index, end_of_lost_job(waiting.pop(index))
                if not done:
                    time.sleep(PATIENCE)
        finally:
            for job in waiting.values():
                job.cancel(check=False)

    def _cancel_left(self) -> None:
        """Cancel jobs that a start of the study which was killed has left in the queue.

        Raises:
            CaseError: they do not end.
        """
        of_study = {file.name.partition("_")[0] for file in self.folder.glob("*_submission.sh")}
        end = time.monotonic() + ANSWER
        while left := of_study & {job.partition("_")[0] for job in queued() or ()}:
            subprocess.run(["scancel", *sorted(left)], capture_output=True, check=False)
            if time.monotonic() > end:
                raise CaseError(
                    f"slurm: the jobs {', '.join(sorted(left))} of an earlier start of this study "
                    "do not end; wait for them, or choose another --output"
                )
            time.sleep(PATIENCE)

    def _submitted(self, tasks: Sequence[Task]) -> list[Any]:
        if find_spec(PACKAGE) is None:
            raise CaseError(f"slurm needs the package {PACKAGE}: pip install {PACKAGE}")
        import submitit

        try:
            executor = submitit.SlurmExecutor(self.folder)
        except RuntimeError as error:
            raise CaseError(f"slurm: {error}; {_cure()}, or leave slurm out") from None
        executor.update_parameters(**self._parameters())
        try:
            return list(executor.map_array(run_here, tasks))
        except submitit.core.utils.FailedJobError as error:
            raise CaseError(f"slurm: {shortened(str(error))}") from None

    def _parameters(self) -> dict[str, Any]:
        """Return the settings under their names in submitit; it leaves out those that are None."""
        asked = self.jobs
        return {
            "job_name": "castx",
            "wckey": None,
            "partition": asked.partition,
            "account": asked.account,
            "qos": asked.qos,
            "constraint": asked.constraint,
            "time": None if asked.time is None else ceil(asked.time / _MINUTE),
            "mem": None if self.memory is None else f"{ceil(self.memory / _MEGABYTE)}MB",
            "signal_delay_s": TO_STOP,
            "cpus_per_task": 1,
            "ntasks_per_node": 1,
            "array_parallelism": self.at_once or MOST_AT_ONCE,
        }


def _cure() -> str:
    """Return the cure where there is no Slurm."""
    if "CASTX_ROOT" in os.environ:
        return "it is not inside the Debian 13 of bin/with-fenicsx: set CASTX_FENICSX=pip"
    return "start the study on a machine of the cluster"


def run_here(task: Task) -> Ended:
    """Make a run on the node of its job, and return its end.

    Raises:
        SystemExit: Slurm has stopped it, and may start the job again: it has no result yet.
    """
    ((_, ended),) = LocalProcesses(processes=1).ended([task])
    if ended.code == INTERRUPTED and STOPPED in ended.said:
        raise SystemExit(f"the run was {STOPPED}")
    return ended


@dataclass
class Absences:
    """Jobs that Slurm knows no more although they have brought nothing, by two looks at its queue.

    The queue is asked for, not the accounts of jobs: not every cluster keeps any.

    Attributes:
        last: when it was looked at last.
        absent: indices of the jobs that were missing there.
    """

    last: float = field(default_factory=time.monotonic)
    absent: frozenset[int] = frozenset()

    def lost(self, jobs: Mapping[int, str]) -> list[int]:
        """Return the indices of jobs that were missing at two looks; without a look due, none.

        Args:
            jobs: numbers of those that have brought nothing yet, by their index.
        """
        if time.monotonic() - self.last < LOOKS:
            return []
        self.last = time.monotonic()
        known = queued()
        if known is None:
            return []
        gone = frozenset(index for index, job in jobs.items() if job not in known)
        lost, self.absent = gone & self.absent, gone
        return sorted(lost)


def queued() -> frozenset[str] | None:
    """Return the numbers of all jobs of this user that wait or run; None: Slurm does not say."""
    command = ["squeue", "--noheader", "--array", f"--user={os.getuid()}", "--format=%i"]
    try:
        asked = subprocess.run(command, capture_output=True, text=True, check=True, timeout=ANSWER)
    except (OSError, subprocess.SubprocessError):
        return None
    return frozenset(asked.stdout.split())


def renew(folder: Path) -> None:
    """Let a network file system look anew at what lies in a folder, by changing nothing of it."""
    with suppress(OSError):
        folder.chmod(folder.stat().st_mode)


def end_of_job(job: Any) -> Ended:
    """Return the end of the run of a job with a result, which may be that it has failed."""
    error = job.exception()
    if error is None:
        ended: Ended = job.result()
        return ended
    if OUT_OF_ITS_TIME in str(error):
        return Ended(INTERRUPTED, f"job {job.job_id}: the time of the job was over", 0.0, 0.0)
    lines = str(error).splitlines()
    named = [line for line in lines if NAMED_ERROR.match(line)]  # the end of a traceback
    return Ended(LOST, f"job {job.job_id}: {shortened([*lines[:1], *named][-1])}", 0.0, 0.0)


def end_of_lost_job(job: Any) -> Ended:
    """Return the end of the run of a job that is gone without a result, with its last line."""
    lines = [line for line in (job.stderr() or "").splitlines() if line.strip()]
    said = f"job {job.job_id} is gone without a result: {shortened((lines or ['no word'])[-1])}"
    return Ended(LOST, said, 0.0, 0.0)
