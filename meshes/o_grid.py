"""Plan of round bodies in quadrilaterals: two rings, the inner one with a square core."""

import math

import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.meshes.grading import Sizing, graded
from castx.meshes.linear_mesh import LinearMesh

Radii = tuple[float, float, float]

CORE = 0.6
"""Half width of the core, as part of the radius of the interface."""

CORNER = (3 + math.sqrt(3)) / 6
"""Coordinates of the core's corner over its half width: all three angles there are 120°."""


def quarter_o_grid(radii: Radii, sizing: Sizing) -> LinearMesh:
    """Return quadrilaterals of two rings in x, y >= 0, the same when x and y are exchanged.

    The inner ring is region 0, the outer one 1. Without a bore the inner one has a core of squares.
    Along the interface the quadrilaterals keep to the size; outside of it they are longer.

    Args:
        radii: of the bore, which may be 0, of the interface and of the outside [m].
        sizing: wanted sizes; they grow away from the interface.
    """
    bore, interface, outer = radii
    count = max(1, math.ceil(interface * math.pi / 4 / sizing.size * (1 - 1e-10)))
    circle = _quarter_circle(count)
    if bore > 0:
        start, width = bore * circle, interface - bore
    else:
        start, width = _core_rim(CORE * interface, count), (1 - CORE) * interface
    inwards = graded(width, sizing, interface - bore)[::-1] / width
    outwards = interface + graded(outer - interface, sizing)
    inner_ring = inwards[:, None, None] * start + (1 - inwards)[:, None, None] * interface * circle
    outer_ring = outwards[1:, None, None] * circle
    points = np.concatenate([inner_ring, outer_ring]).reshape(-1, 2)
    cells = _between(len(inwards) + len(outwards) - 1, len(circle))
    regions: LongArray = np.zeros(len(cells), dtype=np.int64)
    regions[(len(inwards) - 1) * 2 * count :] = 1
    if bore == 0:
        inside, core = _core(CORE * interface, count, len(points))
        points = np.concatenate([points, inside])
        cells = np.concatenate([cells, core])
        regions = np.concatenate([regions, np.zeros(len(core), dtype=np.int64)])
    return LinearMesh(points, cells, regions, np.arange(len(points)))


def _quarter_circle(count: int) -> FloatArray:
    """Return 2 count + 1 unit vectors from x to y, exactly mirrored about the diagonal."""
    angles = 0.25 * math.pi * np.arange(count) / count
    half = np.column_stack([np.cos(angles), np.sin(angles)])
    return np.concatenate([half, np.full((1, 2), math.sqrt(0.5)), half[::-1, ::-1]])


def _core_rim(width: float, count: int) -> FloatArray:
    """Return 2 count + 1 points from (width, 0) by the corner of the core to (0, width)."""
    part = np.arange(count)[:, None] / count
    corner = np.full((1, 2), CORNER * width)
    half = (1 - part) * np.array([[width, 0.0]]) + part * corner
    return np.concatenate([half, corner, half[::-1, ::-1]])


def _between(curves: int, nodes: int) -> LongArray:
    """Return quadrilaterals between neighbouring curves, from the inner to the outer ones."""
    curve, k = np.indices((curves - 1, nodes - 1)).reshape(2, -1)
    first = curve * nodes + k
    return np.column_stack([first, first + nodes, first + nodes + 1, first + 1])


def _core(width: float, count: int, first: int) -> tuple[FloatArray, LongArray]:
    """Return the inner points of the core, numbered from `first`, and its cells.

    Nodes on the rim are those of the first curve, with the numbers from 0 to 2 count.
    """
    s, t = np.indices((count, count)).reshape(2, -1) / count
    shared = CORNER * width * s * t
    points = np.column_stack([width * s * (1 - t) + shared, width * t * (1 - s) + shared])
    i, j = np.indices((count + 1, count + 1))
    number = np.where(i == count, j, np.where(j == count, 2 * count - i, first + i * count + j))
    corners = (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    return points, np.column_stack([corner.ravel() for corner in corners])
