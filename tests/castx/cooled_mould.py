"""A measured case without a solver: the mould warms by a formula with h, depth and time in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from tests.castx.many_runs import CASE, Content

END = 40.0
TIME = np.arange(0.0, END + 0.25, 0.5)
TRUTH = {"h": 1400.0, "depth": 0.0022}
"""What the curves of `written` were made with."""
HEAT = {"law": "constant"}
STUDY = """
[identify]
[[identify.curves]]
of = "near.temperature"
file = "near.csv"
noise = "1 K"
[[identify.unknowns]]
name = "h"
of = "interfaces.0.heat.closed"
"""


def h_of(content: Content) -> np.ndarray[Any, Any]:
    """Return the coefficient at the times, also of a table over time."""
    closed = content["interfaces"][0]["heat"]["closed"]
    if isinstance(closed, dict):
        rows = [[float(str(cell).split()[0]) for cell in row] for row in closed["table"]]
        return np.interp(TIME, *np.array(rows).T)
    return np.full(len(TIME), float(str(closed).split()[0]))


def temperature(h: np.ndarray[Any, Any], depth: float) -> np.ndarray[Any, Any]:
    """Return the mould at a depth: 400 K (1 - e^(-∫h dt/3e4)) e^(-depth/8 mm) above 200 °C."""
    passed = np.concatenate([[0.0], np.cumsum(0.25 * (h[1:] + h[:-1]))]) / 3e4
    return 200.0 + 400.0 * (1.0 - np.exp(-passed)) * np.exp(-depth / 8e-3)


def formula(content: Content) -> tuple[Mapping[str, float], Mapping[str, Sequence[float]]]:
    """Return no answers, and all probes."""
    h = h_of(content)
    if h.max() > 1e5:
        raise RuntimeError("too fast")
    columns: dict[str, Sequence[float]] = {"time": TIME.tolist()}
    for probe in content["probes"]:
        depth = probe["depth"]
        metres = 1e-3 * float(depth.split()[0]) if isinstance(depth, str) else float(depth)
        columns[f"{probe['name']}.temperature"] = [float(t) for t in temperature(h, metres)]
    return {}, columns


def case_text(study: str = STUDY) -> str:
    """Return the case file."""
    return CASE.replace("end = 6", f"end = {END}") + study


def measured(h: Any, depth: float, noise: float, seed: int = 0, late: float = 0.0) -> str:
    """Return a file of a logger, whose clock is late by some time [s]."""
    random = np.random.default_rng(seed)
    values = temperature(np.broadcast_to(h, TIME.shape), depth)
    values = np.interp(TIME, TIME - late, values) + noise * random.normal(size=len(TIME))
    lines = [f"{t:.3f},{y:.6f}" for t, y in zip(TIME[:-2], values[:-2], strict=True)]
    return "\n".join(["time,near.temperature", *lines]) + "\n"
