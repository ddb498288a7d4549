"""Bodies drawn apart: how far each is moved, so that none hides another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from castx.arrays import FloatArray

DISTANCE = 0.06
"""Between bodies on the picture, in diagonals of all of them together."""
NO_OFFSET = 1e-6
"""Share of that diagonal below which a body counts as centred on the largest one."""
WRONG_WAY, NO_WAY = 2.0, 1.3
"""Factors on a way that leads towards the largest body, or across the line to it."""

Rectangle = tuple[FloatArray, FloatArray]
"""Lowest and highest corner on the picture, (2,) each [m]."""


def shifts(points: Sequence[FloatArray], screen: FloatArray, ways: FloatArray) -> FloatArray:
    """Return the shifts of bodies that set their rectangles apart on a picture.

    The largest one stays. The others follow by size, each along the one of some ways that is the
    shortest, where ways back across the largest body count for more.

    Args:
        points: of each body, (points, 3) [m].
        screen: unit vectors to the right and upwards on the picture, (2, 3).
        ways: directions in which bodies may be moved, (directions, 3).

    Returns:
        (bodies, 3) [m].
    """
    rectangles = [_rectangle(own @ screen.T) for own in points]
    centres = np.array([0.5 * (own.min(axis=0) + own.max(axis=0)) for own in points])
    total = _rectangle(np.concatenate([np.array(r) for r in rectangles]))
    size = float(np.linalg.norm(total[1] - total[0]))
    order = sorted(range(len(points)), key=lambda i: -_extent(points[i]))
    moved = np.zeros((len(points), 3))
    placed = [rectangles[order[0]]]
    for index in order[1:]:
        offset = centres[index] - centres[order[0]]
        best = np.inf
        for way in ways:
            length = _clear(rectangles[index], screen @ way, placed, DISTANCE * size)
            cost = length * _weight(float(way @ offset), size)
            if cost < best * (1.0 - NO_OFFSET):
                best, moved[index] = cost, length * way
        low, high = rectangles[index]
        placed.append((low + screen @ moved[index], high + screen @ moved[index]))
    return moved


def _rectangle(points: FloatArray) -> Rectangle:
    return points.min(axis=0), points.max(axis=0)


def _extent(points: FloatArray) -> float:
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def _weight(along: float, size: float) -> float:
    if along > NO_OFFSET * size:
        return 1.0
    return WRONG_WAY if along < -NO_OFFSET * size else NO_WAY


def _clear(own: Rectangle, way: FloatArray, placed: Sequence[Rectangle], distance: float) -> float:
    """Return the distance to move a rectangle along a way until it is clear of those placed."""
    blocked = [_blocked(own, way, other, distance) for other in placed]
    ends = [0.0, *sorted(end for _, end in blocked if end > 0.0)]
    return next(t for t in ends if not any(start < t < end for start, end in blocked))


def _blocked(
    own: Rectangle, way: FloatArray, other: Rectangle, distance: float
) -> tuple[float, float]:
    """Return between which lengths of a way a rectangle is nearer to another one than a distance.

    They are infinite where the way leads nowhere.
    """
    starts, ends = [], []
    for axis in range(2):
        first = other[0][axis] - distance - own[1][axis]
        last = other[1][axis] + distance - own[0][axis]
        if abs(way[axis]) < NO_OFFSET:
            if first < 0.0 < last:
                continue
            return 0.0, 0.0
        bounds = sorted((first / way[axis], last / way[axis]))
        starts.append(bounds[0])
        ends.append(bounds[1])
    return max(starts, default=-np.inf), min(ends, default=np.inf)
