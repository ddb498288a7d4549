"""Directions in which a condition on a surface keeps its mid-sides between the ends of the edges.

What is prescribed at the ends is linear between them: a mid-side has nothing beyond that.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from castx.arrays import FloatArray, IntArray
from castx.domain.measures import nodal_sum
from castx.domain.mesh import BodyMesh
from castx.mechanics.fixed_directions import FixedDirections
from castx.mechanics.midsides.midsides import Midsides


def midside_directions(
    body: BodyMesh, midsides: Midsides, fixed: Sequence[FixedDirections]
) -> list[FixedDirections]:
    """Return the fixed directions of the mid-sides of a body; collective.

    A mid-side has the mean direction of its two ends.

    Args:
        body: mesh of the body.
        midsides: of the body.
        fixed: directions of its nodes.
    """
    return [_of_edges(body, midsides, condition) for condition in fixed]


def _of_edges(body: BodyMesh, midsides: Midsides, condition: FixedDirections) -> FixedDirections:
    directions = _of_all_ranks(body, condition)
    held = np.any(directions != 0.0, axis=1)
    on = midsides.on_surface(condition.surface) if condition.surface else _all(midsides)
    on = on[on < midsides.owned_midsides]
    on = on[held[midsides.ends[on]].all(axis=1)]
    mean = directions[midsides.ends[on]].sum(axis=1)
    length = np.linalg.norm(mean, axis=1)
    on, mean, length = on[length > 0], mean[length > 0], length[length > 0]
    return FixedDirections(
        f"{condition.name}, mid-sides", on, mean / length[:, None], symmetry=condition.symmetry
    )


def _of_all_ranks(body: BodyMesh, condition: FixedDirections) -> FloatArray:
    """Return the directions at the local nodes, zero elsewhere, (nodes, dimension); collective."""
    found = np.zeros((len(body.parent_vertices), body.mesh.geometry.dim))
    found[condition.nodes] = condition.directions
    return np.stack([nodal_sum(body, values) for values in found.T], axis=1)


def _all(midsides: Midsides) -> IntArray:
    return np.arange(midsides.count, dtype=np.int32)
