"""Costs of the parts of a run: stages of PETSc's log, each without the stages inside it.

PETSc logs only when it is told to; until then a stage costs less than a microsecond. The same
stages stand in what PETSc's own option -log_view shows.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from functools import wraps
from pathlib import Path
from typing import ParamSpec, TypeVar

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray

P = ParamSpec("P")
R = TypeVar("R")

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


def booked_as(part: RunPart) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Return a decorator that lets PETSc book a function as a part of the run."""

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        @wraps(function)
        def booked(*arguments: P.args, **options: P.kwargs) -> R:
            stage = PETSc.Log.Stage(stage_name(part))
            stage.push()
            try:
                return function(*arguments, **options)
            finally:
                stage.pop()

        return booked

    return decorate


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
