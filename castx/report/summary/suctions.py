"""The largest suctions of a run: of melt in its mush, and of walls on metal."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from castx.materials.material import ATMOSPHERE
from castx.report.summary.finding import Finding, Shown
from castx.results.reading import Results

TOLD = 1e3
"""Suction from which it is told of [Pa]."""


def suctions(run: Results) -> Iterator[Finding]:
    """Yield the largest suction in the melt of each casting, and at each of its interfaces."""
    for body in run.freezing:
        yield from _suction(
            run, f"{body}.melt_suction", "Largest suction of the melt", body, "melt_suction",
            "Mean stress of melt in the mush; pores open where it reaches `cavitation`, 101 kPa by "
            "default.",
        )  # fmt: skip
    for name in run.interfaces:
        if not set(name.split("/")) & set(run.freezing):  # what pulls between tools is no melt
            continue
        yield from _suction(
            run, f"{name}.suction", "Largest suction at the wall", name, "wall_suction",
            "By this a wall pulls metal that is not solid yet, and cannot leave it; it is no "
            "contact pressure, but part of the force.",
        )  # fmt: skip


def _suction(
    run: Results, column: str, topic: str, of: str, field: str, sentence: str
) -> Iterator[Finding]:
    values = run.history.get(column)
    if values is None or not np.nanmax(values, initial=0.0) >= TOLD:
        return
    largest = int(np.nanargmax(values))
    value, time = float(values[largest]), float(run.history["time"][largest])
    if value > ATMOSPHERE * (1.0 + 1e-6):
        sentence += (
            " It is more than a vacuum pulls: unless the melt is so clean that it bears that, the "
            "part beyond comes from the viscosity of the model, liquid.viscosity."
        )
    body = of.split("/")[0]
    yield Finding(
        topic, of, value, "kPa", sentence, factor=1e-3, time=time,
        shown=Shown(field, (body,), time),
    )  # fmt: skip
