"""Simplices cut where a level is zero: what lies below it stays.

Points near the surface are put onto it, so that no cell is cut close to a corner. Each other edge
that crosses it gets a new point, and each cell that it crosses is divided from the corner of the
lowest number, as are its faces. So two cells divide the face between them alike.

Source: F. Labelle and J. R. Shewchuk, Isosurface stuffing: fast tetrahedral meshes with good
dihedral angles (2007), for moving points first; J. Dompierre et al., How to subdivide pyramids,
prisms, and hexahedra into tetrahedra (1999), for dividing by the numbers of corners.
"""

from __future__ import annotations

from functools import cache
from itertools import combinations

import numpy as np

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.meshes.linear_mesh import handedness

NEAR = 0.25
"""Share of an edge up to which the surface counts as passing through its end."""
LEAST = 0.4
"""Share of its volume that a cell keeps at least when points are moved."""

Polygon = tuple[int, ...]


class Carving:
    """A mesh of tetrahedra of which stays what lies below the level zero.

    Args:
        points: (points, 3) [m].
        cells: (cells, 4).
        levels: at the points, negative where the mesh stays.
        planes: on which of some planes each point lies, (points, planes); it stays there where
            some of the mesh beside it in the plane does.
        fixed: points that are not put onto the surface, (points,).

    Attributes:
        points: those given, some of them moved, then those where the surface crosses edges [m].
    """

    def __init__(
        self,
        points: FloatArray,
        cells: LongArray,
        levels: FloatArray,
        planes: BoolArray,
        fixed: BoolArray,
    ) -> None:
        self._signs = np.sign(levels).astype(np.int64)
        edges = np.unique(_edges(np.sort(cells, axis=1)).reshape(-1, 2), axis=0)
        near, targets = _near_points(points, edges, levels, planes, fixed)
        self._signs[near] = 0
        crossed = edges[self._signs[edges].prod(axis=1) < 0]
        self._count = len(points)
        self._keys = crossed @ (self._count, 1)
        shares = levels[crossed[:, :1]] / (levels[crossed[:, :1]] - levels[crossed[:, 1:]])
        ends = points[crossed]
        new = ends[:, 0] + shares * (ends[:, 1] - ends[:, 0])
        kept = cells[(self._signs[cells] < 0).any(axis=1)]
        self.points = np.concatenate([_moved(points, kept, targets), new])

    def kept(self, simplices: LongArray) -> tuple[LongArray, LongArray]:
        """Return the pieces that stay of cells of the mesh or of their faces, and their parents.

        Args:
            simplices: (simplices, corners), tetrahedra or triangles.

        Returns:
            Corners of the pieces, not oriented, (pieces, corners); numbers of their parents.
        """
        corners = simplices.shape[1]
        ordered = np.sort(simplices, axis=1)
        signs = self._signs[ordered]
        found: list[LongArray] = [np.empty((0, corners), dtype=np.int64)]
        parents: list[LongArray] = [np.empty(0, dtype=np.int64)]
        for pattern in np.unique(signs, axis=0):
            here = np.flatnonzero((signs == pattern).all(axis=1))
            cuts = np.searchsorted(self._keys, _edges(ordered[here]) @ (self._count, 1))
            numbers = np.hstack([ordered[here], self._count + cuts])
            for piece in pieces(tuple(pattern.tolist())):
                found.append(numbers[:, piece])
                parents.append(here)
        return np.concatenate(found), np.concatenate(parents)


def _edges(simplices: LongArray) -> LongArray:
    """Return the edges of simplices with ordered corners, (simplices, edges, 2)."""
    pairs = np.array(list(combinations(range(simplices.shape[1]), 2)))
    return simplices[:, pairs]


def _near_points(
    points: FloatArray, edges: LongArray, levels: FloatArray, planes: BoolArray, fixed: BoolArray
) -> tuple[BoolArray, FloatArray]:
    """Return the points that the surface passes closely, and where along an edge it does.

    Returns:
        Whether it passes, (points,); where, (points, 3) [m], at the point itself if no edge along
        which it may move leads there.
    """
    planes = _kept_planes(edges, levels, planes)
    near, targets = np.zeros(len(points), dtype=np.bool_), points.copy()
    nearest = np.full(len(points), np.inf)
    for start, end in (edges.T, edges.T[::-1]):
        crossing = levels[start] * levels[end] < 0
        start, end = start[crossing & ~fixed[start]], end[crossing & ~fixed[start]]
        shares = levels[start] / (levels[start] - levels[end])
        start, end, shares = (of[shares < NEAR] for of in (start, end, shares))
        near[start] = True
        steps = shares[:, None] * (points[end] - points[start])
        lengths = np.linalg.norm(steps, axis=1)
        lengths[(planes[start] & ~planes[end]).any(axis=1)] = np.inf
        order = np.argsort(-lengths, kind="stable")  # of several the last one, the shortest, stays
        order = order[lengths[order] < nearest[start[order]]]
        nearest[start[order]] = lengths[order]
        targets[start[order]] = points[start[order]] + steps[order]
    return near | (levels == 0.0), targets


def _kept_planes(edges: LongArray, levels: FloatArray, planes: BoolArray) -> BoolArray:
    """Return the planes of each point in which some of the mesh beside it stays."""
    below = planes & (levels < 0.0)[:, None]
    kept = below.copy()
    for start, end in (edges.T, edges.T[::-1]):
        np.logical_or.at(kept, start, planes[start] & below[end])
    return kept


def _moved(points: FloatArray, cells: LongArray, targets: FloatArray) -> FloatArray:
    """Return the points at their targets, except where a cell would lose most of its volume."""
    before, found = handedness(points, cells), targets.copy()
    while True:
        flat = handedness(found, cells) < LEAST * before
        nodes = np.unique(cells[flat])
        nodes = nodes[(found[nodes] != points[nodes]).any(axis=1)]
        if not len(nodes):
            return found
        found[nodes] = points[nodes]


@cache
def pieces(signs: tuple[int, ...]) -> tuple[Polygon, ...]:
    """Return the simplices that stay of one that a surface cuts.

    Args:
        signs: of the level at its three or four corners.

    Returns:
        Corners of each piece: numbers of corners, or behind these of the edges that are cut, in the
        order of their ends.
    """
    corners = range(len(signs))
    if max(signs) <= 0:
        return (tuple(corners),) if min(signs) < 0 else ()
    if min(signs) >= 0:
        return ()
    if len(signs) == 3:
        return _fan(_below((0, 1, 2), signs))
    walls = [_below(face, signs) for face in combinations(corners, 3)]
    walls.append(_section(signs))
    first = min(min(wall, default=len(signs)) for wall in walls)
    opposite = [wall for wall in walls if first not in wall]
    return tuple((first, *triangle) for wall in opposite for triangle in _fan(wall))


def _cut(first: int, second: int, signs: tuple[int, ...]) -> int:
    """Return the number of the point where the surface cuts an edge."""
    edges = list(combinations(range(len(signs)), 2))
    return len(signs) + edges.index((min(first, second), max(first, second)))


def _below(face: tuple[int, int, int], signs: tuple[int, ...]) -> Polygon:
    """Return the part of a triangle that stays, its corners in a circle."""
    found = list[int]()
    for start, end in zip(face, (*face[1:], face[0]), strict=True):
        if signs[start] <= 0:
            found.append(start)
        if signs[start] * signs[end] < 0:
            found.append(_cut(start, end, signs))
    return tuple(found)


def _section(signs: tuple[int, ...]) -> Polygon:
    """Return the polygon in which the surface cuts a tetrahedron, corners in a circle."""
    below = [corner for corner, sign in enumerate(signs) if sign < 0]
    others = [corner for corner, sign in enumerate(signs) if sign >= 0]
    if len(below) == 2:
        others = [*others, *others[::-1]]
        pairs = list(zip((below[0], below[0], below[1], below[1]), others, strict=True))
    else:
        pairs = [(low, other) for low in below for other in others]
    found = [other if signs[other] == 0 else _cut(low, other, signs) for low, other in pairs]
    return tuple(dict.fromkeys(found))


def _fan(polygon: Polygon) -> tuple[Polygon, ...]:
    """Return the triangles of a polygon round its corner of the lowest number."""
    if len(polygon) < 3:
        return ()
    start = polygon.index(min(polygon))
    turned = (*polygon[start:], *polygon[:start])
    return tuple((turned[0], *turned[i : i + 2]) for i in range(1, len(turned) - 1))
