"""Means over the control volumes of nodes by brute force: many points, each in one node's part."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from castx.arrays import FloatArray
from castx.domain.measures import nodal_sum


def control_volume_means(
    body, formula: Callable[[FloatArray], FloatArray], fine: int = 12
) -> FloatArray:
    """Return the means of a formula of the position over the parts of triangles, (nodes,).

    Each triangle is cut into small ones of one size; their centroids belong to the nearest corner
    by barycentric coordinates. Ghosts included; collective.
    """
    topology = body.mesh.topology
    cells = body.nodes.dofmap.list[: topology.index_map(2).size_local]
    shares = small_triangles(fine)
    owner = shares.argmax(axis=1)
    corners = body.points[cells]
    points = np.einsum("qb,cbk->cqk", shares, corners)
    values = formula(points.reshape(-1, 2)).reshape(points.shape[:2])
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = 0.5 * np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    sums = []
    for weights in (values * areas[:, None], np.broadcast_to(areas[:, None], values.shape)):
        local = np.bincount(cells[:, owner].ravel(), weights.ravel(), len(body.points))
        sums.append(nodal_sum(body, local))
    return np.asarray(sums[0] / sums[1])


def small_triangles(fine: int) -> FloatArray:
    """Return the barycentric coordinates of the centroids of equal small triangles, (n, 3)."""
    upward = [(i + 1 / 3, j + 1 / 3) for i in range(fine) for j in range(fine - i)]
    downward = [(i + 2 / 3, j + 2 / 3) for i in range(fine) for j in range(fine - i - 1)]
    first, second = np.array(upward + downward).T / fine
    return np.column_stack([1.0 - first - second, first, second])
