"""How far a run is: its record, its last step, its curves, read from the results folder."""

from __future__ import annotations

import json
import math
import threading
from pathlib import Path
from typing import Any

from castx.case.control import Time
from castx.errors import CaseError
from castx.process.remaining import Remaining
from castx.report.page.charts import merged, run_sections
from castx.results.files.folder import CASE, HISTORY, RECORD
from castx.results.files.reason import Reason
from castx.results.reading import Results

LONGEST = 100_000_000
"""Bytes of a history whose curves are drawn while it grows."""


class RunProgress:
    """Reads a results folder when its history has grown."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._read: tuple[Path, int, dict[str, Any]] | None = None

    def state(self, folder: Path, version: int) -> dict[str, Any]:
        """Return the state of a run, for JSON; its curves only where they are new.

        Args:
            folder: of the results, which may not be there yet.
            version: of the curves that the page has, 0 for none.
        """
        now = version_of(folder)
        if now == 0:
            return {"version": 0}
        with self._lock:
            if self._read is None or self._read[:2] != (folder, now):
                self._read = (folder, now, read_run(folder))
            found = self._read[2]
        if now == version:
            found = {key: value for key, value in found.items() if key != "curves"}
        return {"version": now, **found}


def version_of(folder: Path) -> int:
    """Return a number that changes when a run writes; 0: there is none."""
    try:
        stamps = [(folder / name).stat() for name in (RECORD, HISTORY)]
    except OSError:
        return 0
    # below 2**53, which a page can keep
    return (sum(s.st_mtime_ns // 1_000_000 for s in stamps) + stamps[1].st_size) % 2**52


def read_run(folder: Path) -> dict[str, Any]:
    """Return record, last step and curves of a run, for JSON; one that goes on has no `exit`."""
    if (folder / HISTORY).stat().st_size > LONGEST:
        return {"curves": [], "said": "the history is too long to be drawn here: castx report"}
    try:
        run = Results(folder)
    except CaseError as error:  # a run that has just begun
        return {"curves": [], "said": str(error)}
    solid = {name: float(run.history[f"{name}.solid_fraction"][-1]) for name in run.freezing
             if f"{name}.solid_fraction" in run.history}  # fmt: skip
    exit_reason = run.record["exit"]["reason"]
    goes_on = exit_reason == Reason.RUNNING
    return {
        "exit": "" if goes_on else exit_reason,
        "message": run.record["exit"]["message"],
        "time": float(run.history["time"][-1]),
        "end": run.record["end"],
        "left": left_of(run) if goes_on else None,
        "steps": len(run.history["time"]) - 1,
        "solid": solid,
        "curves": merged({run.case["name"]: run_sections(run)}),
    }


def left_of(run: Results) -> float | None:
    """Return the wall clock time that a run will still take [s]; None: that is not known yet."""
    history, steps = run.history, len(run.history["time"])
    if "wall" not in history or "step" not in history:
        return None
    remaining = Remaining(run.record["end"], _largest_step(run.folder))
    solid = [history.get(f"{name}.solid_fraction") for name in run.freezing[:1]]
    cycles = history.get("cycle")
    for row in range(1, steps):
        remaining.take(
            float(history["time"][row]), float(history["step"][row]), float(history["wall"][row]),
            1.0 if not solid or solid[0] is None else float(solid[0][row]),
            1 if cycles is None else int(cycles[row]),
        )  # fmt: skip
    return remaining.wall()


def _largest_step(folder: Path) -> float:
    """Return the largest step of a run by the case that lies in its folder [s]."""
    try:
        return float(Time.read(json.loads((folder / CASE).read_text())["time"]).largest_step)
    except (OSError, ValueError, KeyError, TypeError):
        return math.inf
