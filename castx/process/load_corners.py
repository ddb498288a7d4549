"""Times at which loads and given temperatures turn, on which steps land.

Mechanics sees its loads at the ends of steps alone: a peak between two of them would not be there
at all. Heat that enters needs none of this, a step takes the mean of its tables.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from castx.case.boundaries import Boundary
from castx.case.case import Case
from castx.case.stages import Schedule
from castx.input.placed import NOW, Placed, PlacedTable
from castx.tables import Table

SMOOTH = 0.02
"""Part of the range of a table by which straight lines may miss it: one that is measured point by
point has few corners."""


def load_corners(case: Case, schedule: Schedule) -> tuple[float, ...]:
    """Return the times at which tables of loads and given temperatures turn [s], ascending.

    Formulas have no corners that are known; what is constant has none.
    """
    turns = {float(time) for table in _tables(case) for time in table.corners(SMOOTH)}
    for stage in case.stages:
        found = (table.corners(SMOOTH) for table in _of_boundaries(stage.boundaries))
        turns |= {float(time) for times in found for time in times if time > stage.at}
    starts = sorted({phase.cycle_start for phase in schedule.phases})
    ends = [*starts[1:], schedule.end]
    return tuple(
        start + turn
        for start, end in zip(starts, ends, strict=True)
        for turn in sorted(turns)
        if 0.0 < turn < end - start
    )


def stops_of(phases: Sequence[float], corners: Iterable[float], least: float) -> tuple[float, ...]:
    """Return the times on which steps land [s], ascending.

    Args:
        phases: at which phases begin, which are all among them.
        corners: which are left out where another time follows sooner than the smallest step: what
            jumps within it does so in one step.
        least: the smallest step [s].
    """
    kept, begins = list[float](), set(phases)
    for time in sorted({*phases, *corners}, reverse=True):
        if time in begins or not kept or kept[-1] - time > least:
            kept.append(time)
    return tuple(reversed(kept))


def _tables(case: Case) -> Iterator[Table]:
    for body in case.bodies:
        if body.temperature_history is not None:
            yield body.temperature_history
    yield from _of_boundaries(case.boundaries)


def _of_boundaries(boundaries: Iterable[Boundary]) -> Iterator[Table]:
    """Yield tables over time of displacements, forces and pressures."""
    for boundary in boundaries:
        for displacement in boundary.displacement:
            if displacement.value is not None:
                yield displacement.value
        if boundary.clamp is not None and boundary.clamp.force is not None:
            yield boundary.clamp.force
        for load in (boundary.pressure, *(boundary.traction or ())):
            if load is not None:
                yield from _over_time(load)


def _over_time(load: Table | Placed) -> Iterator[Table]:
    """Yield the tables over time of a load, of each of its places."""
    if isinstance(load, Table):
        yield load
    elif isinstance(load, PlacedTable) and NOW in load.axes:
        axis = load.axes.index(NOW)
        times = load.places[axis]
        for values in np.moveaxis(load.values, axis, -1).reshape(-1, len(times)):
            yield Table(times, values)
