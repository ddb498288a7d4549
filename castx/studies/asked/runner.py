"""How the runs of a study are made: how many at once, with which memory and time."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from pydantic import PlainValidator

from castx.errors import CaseError
from castx.input.entries import Description, Quantity, Whole
from castx.input.units import TIME, Dimension
from castx.studies.asked.slurm import SlurmJobs

MEMORY = Dimension("an amount of memory", "byte", ("GB", "MB"))
_MOST_PROCESSES = 1000
_LEAST_MEMORY = 3e8
"""Below which a run cannot load what it needs, and may wait for it for ever [byte]."""


def _folder(value: Any) -> Path:
    if not isinstance(value, str | Path) or not str(value).strip() or "\0" in str(value):
        raise CaseError("a folder is needed, relative to the working directory")
    return Path(value)


def _memory(value: Any) -> float:
    read = Quantity(MEMORY, above=0.0).read(value)
    if read < _LEAST_MEMORY:
        raise CaseError('a run takes 300 MB before it begins; give more, such as "2 GB"')
    return read


class Running(Description):
    """Settings that all studies share.

    Attributes:
        processes: runs at once; None: as many as there are cores.
        memory: that each run may take [byte]; None: no limit.
        time_limit: wall clock time of each run, after which it counts as failed [s].
        folder: of the study; None: results/NAME-OF-THE-CASE-FILE.STUDY.
        slurm: settings of jobs on a cluster; None: the runs are processes of this machine.
    """

    processes: Annotated[int | None, Whole(1, _MOST_PROCESSES)] = None
    memory: Annotated[float | None, PlainValidator(_memory)] = None
    time_limit: Annotated[float | None, Quantity(TIME, above=0.0)] = None
    folder: Annotated[Path | None, PlainValidator(_folder)] = None
    slurm: SlurmJobs | None = None
