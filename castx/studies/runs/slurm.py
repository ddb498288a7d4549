"""Runs as an array of jobs of Slurm, each on one core of a cluster, by the package submitit."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from math import ceil
from pathlib import Path
from typing import Any

from castx.errors import CaseError
from castx.input.child_process import shortened
from castx.studies.asked.slurm import SlurmJobs
from castx.studies.runs.executor import Ended, Task
from castx.studies.runs.local import LocalProcesses

PACKAGE, JOBS = "submitit", "jobs"
"""What hands runs to Slurm, and the folder of a study for what both write."""
PATIENCE = 1.0
"""Time between two looks at the results of jobs [s]."""
MOST_AT_ONCE = 256
LOST = -1
"""Exit code of a run whose job has brought nothing."""
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
        waiting = dict(enumerate(self._submitted(tasks)))
        try:
            while waiting:
                done = [index for index, job in waiting.items() if job.done()]
                for index in done:
                    yield index, end_of_job(waiting.pop(index))
                if not done:
                    time.sleep(PATIENCE)
        finally:
            for job in waiting.values():
                job.cancel(check=False)

    def _submitted(self, tasks: Sequence[Task]) -> list[Any]:
        if find_spec(PACKAGE) is None:
            raise CaseError(f"slurm needs the package {PACKAGE}: pip install {PACKAGE}")
        import submitit

        try:
            executor = submitit.SlurmExecutor(self.folder)
        except RuntimeError as error:
            raise CaseError(
                f"slurm: {error}; start the study on a machine of the cluster, or leave slurm out"
            ) from None
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
            "cpus_per_task": 1,
            "ntasks_per_node": 1,
            "array_parallelism": self.at_once or MOST_AT_ONCE,
        }


def run_here(task: Task) -> Ended:
    """Make a run on the node of its job, and return its end."""
    ((_, ended),) = LocalProcesses(processes=1).ended([task])
    return ended


def end_of_job(job: Any) -> Ended:
    """Return the end of the run of a job that is done; a job without a result has lost its run."""
    error = job.exception()
    if error is None:
        ended: Ended = job.result()
        return ended
    lines = str(error).splitlines()
    named = [line for line in lines if NAMED_ERROR.match(line)]  # the end of a traceback
    return Ended(LOST, f"job {job.job_id}: {shortened([*lines[:1], *named][-1])}", 0.0, 0.0)
