"""The extreme value of a quantity over all ranks, and its place."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray, LongArray

TIE = 1e-9
"""Relative difference of values that counts as none: rounding would else choose the place."""


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
