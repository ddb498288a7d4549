"""The extreme value of a quantity over all ranks, its place, and quantiles over the volume."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray, LongArray

TIE = 1e-9
"""Relative difference of values that counts as none: rounding would else choose the place."""

BISECTIONS = 40
"""Halvings of the range of a quantity: more than its digits."""


def largest(
    comm: MPI.Intracomm, values: FloatArray, numbers: LongArray, points: FloatArray
) -> dict[str, Any]:
    """Return the largest value and where it is, as JSON knows them; collective.

    Of entities with the same value it is the first in the mesh before it was distributed.

    Args:
        comm: the ranks.
        values: of the owned entities (n,); there is one on some rank.
        numbers: of these entities, which do not depend on the ranks, (n,).
        points: where they are, (n, gdim) [m].
    """
    value = comm.allreduce(float(values.max(initial=-np.inf)), op=MPI.MAX)
    tied = np.flatnonzero(values >= value - TIE * abs(value))
    beyond = np.iinfo(np.int64).max
    first = comm.allreduce(int(numbers[tied].min(initial=beyond)), op=MPI.MIN)
    here = points[tied[numbers[tied] == first]].tolist()
    place = next(found[0] for found in comm.allgather(here) if found)
    return {"value": value, "place": place}


def smallest(
    comm: MPI.Intracomm, values: FloatArray, numbers: LongArray, points: FloatArray
) -> dict[str, Any]:
    """Return the smallest value and where it is, arguments as for `largest`; collective."""
    found = largest(comm, -values, numbers, points)
    return {**found, "value": -found["value"]}


def quantile(comm: MPI.Intracomm, values: FloatArray, volumes: FloatArray, share: float) -> float:
    """Return the value that a share of the volume does not exceed, by bisection; collective.

    Args:
        comm: the ranks.
        values: of the owned entities (n,); there is one on some rank.
        volumes: of these entities (n,) [m³].
        share: of the whole volume, from 0 to 1.
    """
    low = float(comm.allreduce(float(values.min(initial=np.inf)), op=MPI.MIN))
    high = -float(comm.allreduce(float((-values).min(initial=np.inf)), op=MPI.MIN))
    wanted = share * comm.allreduce(float(volumes.sum()), op=MPI.SUM)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        below = comm.allreduce(float(volumes[values <= middle].sum()), op=MPI.SUM)
        low, high = (low, middle) if below >= wanted else (middle, high)
    return high
