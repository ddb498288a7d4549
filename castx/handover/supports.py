"""Supports of a body: its planes of symmetry, and as few more as hold its rigid motions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg

from castx.arrays import FloatArray, IntArray, LongArray

ON_PLANE = 1e-6
"""Distance from a plane, beside the extent of the body, below which a node lies on it."""
FREE = 1e-8
"""Share of the largest eigenvalue below which a rigid motion counts as free."""
ALIGNED = 1.0 - 1e-9

Plane = tuple[FloatArray, float]


@dataclass(frozen=True, eq=False)
class Holding:
    """Conditions that hold a body.

    Attributes:
        nodes: of each condition, (conditions,).
        directions: in which the node does not move, of length 1, (conditions, 3).
        minimal: how many of them, the last ones, hold rigid motions alone.
    """

    nodes: LongArray
    directions: FloatArray
    minimal: int

    def without_reactions(self, forces: FloatArray) -> FloatArray:
        """Return nodal forces (nodes, 3) without the reactions of the planes of symmetry."""
        left = forces.copy()
        count = len(self.nodes) - self.minimal
        borne: dict[int, list[FloatArray]] = {}
        for index in range(count):
            node, direction = int(self.nodes[index]), self.directions[index]
            for earlier in borne.setdefault(node, []):
                direction = direction - (direction @ earlier) * earlier
            size = float(np.linalg.norm(direction))
            if size < FREE:
                continue
            direction = direction / size
            borne[node].append(direction)
            left[node] -= (left[node] @ direction) * direction
        return left


def supports(points: FloatArray, model: str, planes: Sequence[Plane]) -> Holding:
    """Return the planes of symmetry and the fewest further supports as conditions.

    Args:
        points: positions of the nodes, (nodes, 3) [m].
        model: geometric model.
        planes: of symmetry; the axis of axisymmetric bodies needs none.
    """
    extent = float(np.ptp(points, axis=0).max())
    nodes, directions = [], []
    if model == "axisymmetric":
        planes = [*planes, (np.array([1.0, 0.0, 0.0]), 0.0)]
    for normal, offset in planes:
        on_it = np.flatnonzero(np.abs(points @ normal - offset) <= ON_PLANE * extent)
        nodes.append(on_it)
        directions.append(np.tile(normal, (len(on_it), 1)))
    held_nodes = np.concatenate([np.empty(0, dtype=np.int64), *nodes])
    held = np.concatenate([np.empty((0, 3)), *directions])
    further, axes = _further(points, model, held_nodes, held)
    return Holding(
        np.concatenate([held_nodes, further]), np.concatenate([held, np.eye(3)[axes]]), len(further)
    )


def rigid_motions(points: FloatArray, model: str) -> FloatArray:
    """Return the rigid motions of the nodes, those of a plane model in it, (nodes, 3, motions)."""
    shifts = np.broadcast_to(np.eye(3), (len(points), 3, 3))
    if model == "axisymmetric":
        return shifts[:, :, 1:2]
    middle = points.mean(axis=0)
    away = (points - middle) / np.ptp(points, axis=0).max()
    turns = np.stack([np.cross(axis, away) for axis in np.eye(3)], axis=2)
    if model == "3d":
        return np.concatenate([shifts, turns], axis=2)
    return np.concatenate([shifts[:, :, :2], turns[:, :, 2:]], axis=2)


def _further(
    points: FloatArray, model: str, held_nodes: LongArray, held: FloatArray
) -> tuple[LongArray, IntArray]:
    """Return nodes and axes that hold the rigid motions which conditions leave, one for each."""
    motions = rigid_motions(points, model)
    left = np.eye(motions.shape[2])
    if len(held):
        rows = np.einsum("ci,cim->cm", held, motions[held_nodes])
        _, sizes, right = np.linalg.svd(rows.T @ rows / len(rows))
        left = right[sizes <= FREE * sizes[0]].T
    if left.shape[1] == 0:
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int32)
    free = (motions @ left).reshape(-1, left.shape[1])
    # Columns in the order in which each adds most to those before it.
    _, order = scipy.linalg.qr(free.T, mode="r", pivoting=True)
    chosen = np.asarray(order[: left.shape[1]])
    return chosen // 3, (chosen % 3).astype(np.int32)
