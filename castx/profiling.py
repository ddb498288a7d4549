"""Costs of the parts of a run: stages of PETSc's log, each without the stages inside it.

PETSc logs only when it is told to; until then a stage costs less than a microsecond. The same
stages stand in what PETSc's own option -log_view shows.
"""

from __future__ import annotations

import re
import tempfile
from contextlib import ContextDecorator
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray

REST = "Main Stage"
"""PETSc's stage for all that is in no other one."""

_SUMMARY = re.compile(
    r'^Stages\["(.+)"\]\["summary"\]\[(\d+)\] = \{"time" : ([^,]+), "numMessages" : ([^,]+), '
    r'"messageLength" : ([^,]+), "numReductions" : ([^,]+), "flop" : ([^}]+)\}$',
    re.MULTILINE,
)


class RunPart(StrEnum):
    """A part of a run."""

    START = "start"
    HEAT = "heat"
    ASSEMBLY = "assembly"
    CONTACT = "contact"
    SET_UP = "set-up"
    SOLVE = "solve"
    OUTPUT = "output"
    REST = "rest"


@dataclass(frozen=True)
class PartCost:
    """Cost of a part of a run.

    Attributes:
        time: wall clock time of the rank with the largest one [s].
        mean_time: mean over the ranks [s].
        flops: floating-point operations of PETSc, of all ranks.
        messages: that its vectors and matrices sent from rank to rank.
        sent: bytes of these messages.
        reductions: sums and the like of PETSc over all ranks.
    """

    time: float
    mean_time: float
    flops: float
    messages: float
    sent: float
    reductions: float


class booked_as(ContextDecorator):
    """Decorator of a function, or context of some lines, that PETSc books as a part of the run.

    Args:
        part: of the run.
    """

    def __init__(self, part: RunPart) -> None:
        self._name = stage_name(part)

    def __enter__(self) -> None:
        PETSc.Log.Stage(self._name).push()

    def __exit__(self, *_: object) -> None:
        PETSc.Log.Stage(self._name).pop()


def stage_name(part: RunPart) -> str:
    """Return the name of the stage of a part in PETSc's log."""
    return REST if part is RunPart.REST else f"castx {part}"


class Profile:
    """The cost of the parts of a run since this object was made, to the six digits of PETSc's log.

    PETSc goes on logging to the end of the process.

    Args:
        comm: the ranks of the run.
    """

    def __init__(self, comm: MPI.Intracomm) -> None:
        self._comm = comm
        PETSc.Log.begin()
        self._start = self._booked()

    def costs(self) -> dict[RunPart, PartCost]:
        """Return the cost of each part so far; collective."""
        booked = self._booked() - self._start
        parts: list[RunPart] = list(RunPart)
        return {part: _cost(booked[k]) for k, part in enumerate(parts)}

    def _booked(self) -> FloatArray:
        """Return the numbers of `_SUMMARY`, shape (parts, numbers, ranks); collective."""
        found = {
            (name, int(rank)): [float(number) for number in numbers]
            for name, rank, *numbers in _SUMMARY.findall(self._log())
        }
        none = [0.0] * (_SUMMARY.groups - 2)
        ranks = range(self._comm.size)
        return np.array(
            [[found.get((stage_name(part), rank), none) for rank in ranks] for part in RunPart]
        ).swapaxes(1, 2)

    def _log(self) -> str:
        """Return PETSc's log with the numbers of each rank, the same text on all; collective."""
        with tempfile.TemporaryDirectory(prefix="castx-") as folder:
            path = Path(folder) / "log"
            viewer = PETSc.Viewer().createASCII(str(path), comm=self._comm)
            viewer.pushFormat(PETSc.Viewer.Format.ASCII_INFO_DETAIL)
            PETSc.Log.view(viewer)
            viewer.destroy()
            text = path.read_text() if self._comm.rank == 0 else ""
        return str(self._comm.bcast(text))


def _cost(numbers: FloatArray) -> PartCost:
    """Return the cost from the numbers of `_SUMMARY` of each rank; messages count at both ends."""
    times, messages, sent, reductions, flops = numbers
    return PartCost(
        time=float(times.max()),
        mean_time=float(times.mean()),
        flops=float(flops.sum()),
        messages=0.5 * float(messages.sum()),
        sent=0.5 * float(sent.sum()),
        reductions=float(reductions.max()),
    )
