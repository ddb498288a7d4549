"""Curves of many runs at the same probes: bands that hold most of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.results.files.run_tables import RunTables

SHARES = (0.05, 0.5, 0.95)
POINTS = 201


@dataclass(frozen=True, eq=False)
class Band:
    """Values of one column of probes.csv over all runs.

    Attributes:
        column: its name.
        time: [s], (points,).
        low: what 5 % of the runs are below, (points,).
        middle: the median, (points,).
        high: what 95 % of the runs are below, (points,).
    """

    column: str
    time: FloatArray
    low: FloatArray
    middle: FloatArray
    high: FloatArray


def curve_bands(runs: Sequence[RunTables]) -> list[Band]:
    """Return the band of each column that all runs have, over the time that all have reached.

    Args:
        runs: finished ones, at least one.
    """
    tables = [run.probes for run in runs]
    end = min(float(table["time"][-1]) for table in tables)
    time = np.asarray(np.linspace(0.0, end, POINTS), dtype=np.float64)
    shared = [name for name in tables[0] if name != "time" and all(name in t for t in tables)]
    found = []
    for name in shared:
        values = np.array([np.interp(time, table["time"], table[name]) for table in tables])
        if np.isfinite(values).all():
            low, middle, high = np.quantile(values, SHARES, axis=0)
            found.append(Band(name, time, low, middle, high))
    return found
