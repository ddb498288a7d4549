"""Events of a run: the moments of the pictures of the report."""

from __future__ import annotations

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.results.reading import Results
from castx.results.states.snapshot import FULLY_SOLID

FRACTIONS = {0.25: "25 % solid", 0.5: "50 % solid", 0.75: "75 % solid", FULLY_SOLID: "all solid"}
OPEN = 1e-6
"""Gap from which an air gap counts [m]."""


def moments(run: Results) -> dict[float, str]:
    """Return the events of a run, by their time [s].

    That is when the first casting is by a quarter, a half, three quarters and all solid, when its
    first air gap opens, when stages of the first cycle begin, and the end.
    """
    time = run.history["time"]
    found: dict[float, str] = {}
    for body in run.freezing[:1]:
        solid = run.history[f"{body}.solid_fraction"]
        for fraction, text in FRACTIONS.items():
            add(found, first_time(time, solid >= fraction), text)
    gaps = [
        run.history[f"{name}.max_gap"]
        for name in run.record["interfaces"]
        if f"{name}.max_gap" in run.history
    ]
    if gaps:
        add(found, first_time(time, np.any(np.array(gaps) > OPEN, axis=0)), "first air gap")
    for event in run.record.get("process", []):
        if event.get("stage") and event.get("cycle") == 1:
            add(found, event["time"], f"stage {event['stage']}")
    add(found, float(time[-1]), "end")
    return found


def first_time(time: FloatArray, reached: BoolArray) -> float | None:
    """Return the first time at which something was reached, None if it never was or always."""
    steps = np.flatnonzero(reached)
    return float(time[steps[0]]) if steps.size and steps[0] > 0 else None


def add(found: dict[float, str], time: float | None, text: str) -> None:
    """Add an event; nothing if its time is None."""
    if time is not None:
        found[time] = f"{found[time]}, {text}" if time in found else text
