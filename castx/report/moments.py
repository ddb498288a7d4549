"""Events of a run: the moments of the pictures of the report."""

from __future__ import annotations

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.results.field_times import FIRST_GAP, FRACTIONS, OPEN, crossing
from castx.results.reading import Results


def moments(run: Results) -> dict[float, str]:
    """Return the events of a run, by their time [s].

    That is when the first casting is by a quarter, a half, three quarters, 95 % and all solid, when
    its first air gap opens, when stages of the first cycle begin, and the end.
    """
    time = run.history["time"]
    found: dict[float, str] = {}
    for body in run.freezing[:1]:
        solid = run.history[f"{body}.solid_fraction"]
        for fraction, text in FRACTIONS.items():
            add(found, crossing_time(time, solid, fraction), text)
    gaps = [
        run.history[f"{name}.max_gap"]
        for name in run.record["interfaces"]
        if f"{name}.max_gap" in run.history
    ]
    if gaps:
        add(found, first_time(time, np.any(np.array(gaps) > OPEN, axis=0)), FIRST_GAP)
    for event in run.record.get("process", []):
        if event.get("stage") and event.get("cycle") == 1:
            add(found, event["time"], f"stage {event['stage']}")
    add(found, float(time[-1]), "end")
    return found


def crossing_time(time: FloatArray, solid: FloatArray, wanted: float) -> float | None:
    """Return when a solid fraction was reached first, None if it never was or always.

    Args:
        time: of the steps [s].
        solid: the solid fractions then.
        wanted: that is to be reached.
    """
    steps = np.flatnonzero(solid >= wanted)
    if not steps.size or steps[0] == 0:
        return None
    after = steps[0]
    step = float(time[after - 1]), float(time[after])
    return crossing(step, (float(solid[after - 1]), float(solid[after])), wanted)


def first_time(time: FloatArray, reached: BoolArray) -> float | None:
    """Return the first time at which something was reached, None if it never was or always."""
    steps = np.flatnonzero(reached)
    return float(time[steps[0]]) if steps.size and steps[0] > 0 else None


def add(found: dict[float, str], time: float | None, text: str) -> None:
    """Add an event; nothing if its time is None."""
    if time is not None:
        found[time] = f"{found[time]}, {text}" if time in found else text
