"""run.json: case, versions, effort and end of a run."""

from __future__ import annotations

import json
import math
import resource
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from mpi4py import MPI

from castx.environment import versions
from castx.profiling import PartCost, RunPart
from castx.results.files.folder import write_whole
from castx.results.files.reason import Reason
from castx.results.states.snapshot import Snapshot
from castx.solvers.counters import StepCounters


def timestamp() -> str:
    """Return the present moment as ISO 8601 in UTC."""
    return datetime.now(UTC).isoformat(timespec="seconds")


@dataclass
class RunRecord:
    """The record of one run, kept up to date on every rank and written by one.

    Args:
        path: the file.
        description: the parts that do not change (case, bodies, interfaces, ranks).
    """

    path: Path
    description: Mapping[str, Any]
    _started: str = field(default_factory=timestamp)
    _clock: float = field(default_factory=time.perf_counter)
    _counts: dict[str, int] = field(default_factory=lambda: {"steps": 0, **StepCounters().counts()})
    _reached: float = 0.0
    _last: dict[str, float] = field(default_factory=dict)
    _memory: dict[str, int] = field(default_factory=dict)
    _wall_before: float = 0.0
    _restarts: list[dict[str, Any]] = field(default_factory=list)
    _events: list[Mapping[str, Any]] = field(default_factory=list)
    _profile: dict[str, Any] = field(default_factory=dict)
    _hot_spots: list[dict[str, Any]] = field(default_factory=list)
    _stage_ends: list[dict[str, Any]] = field(default_factory=list)
    _followed: dict[str, Any] = field(default_factory=dict)

    def update(self, snapshot: Snapshot) -> None:
        """Take over the state after an accepted step; collective."""
        self._reached = snapshot.time
        self._last = dict(snapshot.totals)
        self._events = list(snapshot.process.events)
        self._memory = peak_memory(snapshot.mesh.comm)
        if snapshot.step > 0:
            self._counts["steps"] += 1
            for name, count in snapshot.counters.counts().items():
                self._counts[name] += count

    def note_profile(self, costs: Mapping[RunPart, PartCost]) -> None:
        """Store the costs of the parts of the run."""
        self._profile = {"profile": {str(part): asdict(cost) for part, cost in costs.items()}}

    def note_hot_spots(self, found: list[dict[str, Any]]) -> None:
        """Take over the isolated pools of liquid, the worst first."""
        self._hot_spots = found

    def note_stage_ends(self, found: list[dict[str, Any]]) -> None:
        """Take over stresses and distortion at the ends of the stages."""
        self._stage_ends = found

    def note_followed(self, found: dict[str, Any]) -> None:
        """Store the other histories of the run, by subject."""
        self._followed = found

    def notes(self) -> dict[str, Any]:
        """Return the content for the record of a run that goes on from here."""
        return {
            "started": self._started,
            "wall": self._wall,
            "totals": self._counts,
            "time_reached": self._reached,
            "restarts": self._restarts,
        }

    def resume(self, notes: Mapping[str, Any]) -> None:
        """Go on with the record of an earlier part of the run."""
        self._restarts = [
            *notes["restarts"],
            {"at": notes["time_reached"], "started": self._started},
        ]
        self._started, self._wall_before = notes["started"], notes["wall"]
        self._counts |= notes["totals"]
        self._reached = notes["time_reached"]

    @property
    def _wall(self) -> float:
        return self._wall_before + time.perf_counter() - self._clock

    def write(self, reason: Reason, message: str = "") -> None:
        """Write the file; local, so that one rank can do it whatever the others are doing."""
        content = {
            "castx": versions()["castx"],
            **self.description,
            "versions": versions(),
            "started": self._started,
            "written": timestamp(),
            "time_reached": self._reached,
            "totals": self._counts,
            "last": {name: number(value) for name, value in self._last.items()},
            "process": self._events,
            "hot_spots": self._hot_spots,
            "stage_ends": self._stage_ends,
            **self._followed,
            "wall": self._wall,
            "restarts": self._restarts,
            "peak_memory": self._memory,
            **self._profile,
            "exit": {"reason": str(reason), "message": message},
        }
        write_whole(self.path, json.dumps(content, indent=2, ensure_ascii=False) + "\n")


def peak_memory(comm: MPI.Intracomm) -> dict[str, int]:
    """Return the peak resident memory so far [bytes]: of the largest rank, and of all."""
    own = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return {
        "largest_rank": int(comm.allreduce(own, MPI.MAX)),
        "all_ranks": int(comm.allreduce(own, MPI.SUM)),
    }


def number(value: float) -> float | None:
    """Return a number as JSON knows it: not a number and infinity become null."""
    return float(value) if math.isfinite(value) else None
