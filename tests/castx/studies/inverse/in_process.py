"""An executor of studies that runs castx in this process."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mpi4py import MPI

from castx.command.run import run
from castx.studies.runs.executor import Ended, Task


class InProcess:
    """Executor that runs castx in this process.

    Args:
        comm: of one rank.
    """

    def __init__(self, comm: MPI.Intracomm) -> None:
        self.comm = comm

    def ended(self, tasks: Sequence[Task]) -> Iterator[tuple[int, Ended]]:
        for index, task in enumerate(tasks):
            _, case_file, _, output, *sets = task.arguments
            run(case_file, sets[1::2], output=output, comm=self.comm)
            yield index, Ended(0, "", 0.0, 0.0)
