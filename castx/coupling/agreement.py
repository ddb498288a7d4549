"""Change of the resistances of the interfaces from one pass to the next."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray

LONE = 100.0
"""Change of a lone pair that counts as much as one of all pairs: where it opens by less than a
micrometre its resistance moves by percents, and hardly any heat with it."""

ROUNDED = 1e-8
"""Change of the resistances that is rounding after a pass that changes no force by more, or once
passes no longer come closer to each other: heat is rounded too, and moves forces. Forces of 2e-14
of those in a body move it on springs of 1e-7 of its stiffness, and its gaps with it: those of a
block in its mould were rounded to 2e-10 of themselves."""


def disagreement(
    comm: MPI.Intracomm, found: FloatArray, tried: FloatArray, areas: FloatArray
) -> float:
    """Return the relative change of the resistances of all pairs; collective.

    It is the root of the mean square over the areas of the pairs, or the largest change over `LONE`
    if that is more.

    Args:
        comm: ranks that share the pairs.
        found: resistances after a pass [m² K/W], shape (pairs,).
        tried: those with which it began, likewise.
        areas: of the pairs [m²], likewise.

    Returns:
        The change; infinite where a pair begins or ends to conduct at all.
    """
    finite = np.isfinite(found)
    compared = finite & np.isfinite(tried) & (found > 0)
    change = np.abs(found[compared] - tried[compared]) / found[compared]
    largest = np.inf if (finite != np.isfinite(tried)).any() else change.max(initial=0.0)
    sums = comm.allreduce(np.array([areas[compared] @ change**2, areas[compared].sum()]))
    mean = np.sqrt(sums[0] / sums[1]) if sums[1] > 0 else 0.0
    return float(max(mean, comm.allreduce(float(largest), op=MPI.MAX) / LONE))
