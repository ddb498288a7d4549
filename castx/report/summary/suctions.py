"""The largest suctions of a run: of melt in its mush, and of walls on metal."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np

from castx.arrays import BoolArray
from castx.materials.material import ATMOSPHERE
from castx.report.summary.finding import Finding, Shown
from castx.results.reading import Results
from castx.results.states.snapshot import FULLY_SOLID

TOLD = 1e3
"""Suction from which it is told of [Pa]."""


def suctions(run: Results) -> Iterator[Finding]:
    """Yield the largest suction in the melt of each casting, then at its walls, largest first."""
    for body in run.freezing:
        yield from _suction(
            run, f"{body}.melt_suction", "Largest suction of the melt", body, "melt_suction",
            "Mean stress of melt in the mush; pores open where it reaches `cavitation`, 101 kPa by "
            "default.",
        )  # fmt: skip
    walls: list[Finding] = []
    for name in run.interfaces:
        castings = set(name.split("/")) & set(run.freezing)
        if not castings:  # what pulls between tools is no melt
            continue
        walls += _suction(
            run, f"{name}.suction", "Largest suction at the wall", name, "wall_suction",
            "By this a wall pulls metal that is not solid yet, and cannot leave it; it is no "
            "contact pressure, but part of the force.", castings,
        )  # fmt: skip
    yield from sorted(walls, key=lambda wall: -wall.value)


def _suction(
    run: Results,
    column: str,
    topic: str,
    of: str,
    field: str,
    sentence: str,
    castings: Collection[str] = (),
) -> Iterator[Finding]:
    """Yield the largest value of a column, of walls while one of the castings is not solid."""
    values = run.history.get(column)
    if values is None:
        return
    if castings:
        values = np.where(_molten(run, castings), values, 0.0)
    if not np.nanmax(values, initial=0.0) >= TOLD:
        return
    largest = int(np.nanargmax(values))
    value, time = float(values[largest]), float(run.history["time"][largest])
    if value > ATMOSPHERE * (1.0 + 1e-6):
        sentence += (
            " It is more than a vacuum pulls: unless the melt is so clean that it bears that, the "
            "part beyond is of the model: of its liquid.viscosity, or of coarse cells with liquid "
            "and solid nodes."
        )
    body = of.split("/")[0]
    yield Finding(
        topic, of, value, "kPa", sentence, factor=1e-3, time=time,
        shown=Shown(field, (body,), time),
    )  # fmt: skip


def _molten(run: Results, castings: Collection[str]) -> BoolArray:
    """Return in which steps one of the castings was not all solid, at their start at least.

    What pairs of solid metal pull by later is within what an equilibrium leaves undone.
    """
    found = np.zeros(len(run.history["time"]), dtype=np.bool_)
    for body in castings:
        fraction = run.history.get(f"{body}.solid_fraction")
        if fraction is None:
            found[:] = True
        else:
            found |= np.append(fraction[:1], fraction[:-1]) < FULLY_SOLID
    return found
