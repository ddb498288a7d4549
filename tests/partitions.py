"""Ways of giving cells to ranks that code of several ranks has to stand, in place of good ones.

Each takes the arguments of `castx.domain.partition.partition`. A test puts one in its place before
it builds a mesh: `monkeypatch.setattr(PARTITION, scattered)`.
"""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray, LongArray

PARTITION = "castx.domain.mesh.partition"


def scattered(
    midpoints: FloatArray, bodies: LongArray, across: LongArray, parts: int
) -> LongArray:
    """Give neighbouring cells to different ranks, and part the cells at an interface."""
    return np.arange(len(bodies)) % parts


def thinly_scattered(
    midpoints: FloatArray, bodies: LongArray, across: LongArray, parts: int
) -> LongArray:
    """Give all cells to rank 0 but every fifth, so that ranks meet at nodes without a ghost cell.

    The owner of a node may then have none of the cells that matter there.
    """
    cells = np.arange(len(bodies))
    return np.where(cells % 5 == 0, (cells // 5) % max(parts - 1, 1) + 1, 0) % parts


def along_x(midpoints: FloatArray, bodies: LongArray, across: LongArray, parts: int) -> LongArray:
    """Give each rank the cells of one range of x, whatever interfaces that parts."""
    place = np.argsort(np.argsort(midpoints[:, 0], kind="stable"), kind="stable")
    return place * parts // len(bodies)


def on_the_last(
    midpoints: FloatArray, bodies: LongArray, across: LongArray, parts: int
) -> LongArray:
    """Give all cells to the last rank, and none to the others."""
    return np.full(len(bodies), parts - 1)
