"""Closest points on the facets of a surface: lines in the plane, triangles and quadrilaterals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from castx.arrays import FloatArray, LongArray

HALVES = ((0, 1, 3), (0, 3, 2))
"""Triangles of a quadrilateral with the corners in the order of DOLFINx."""

EQUAL = 1e-9
"""Difference of distances, in sizes of a facet, below which two facets are equally close."""


@dataclass(frozen=True)
class ClosestPoints:
    """The closest point of a surface to each of some points.

    Attributes:
        facet: the facet that it lies on, shape (n,).
        weights: shape functions of the corners of that facet, shape (n, corners).
        normals: mean of the normals of all facets that are equally close, shape (n, dimension).
    """

    facet: LongArray
    weights: FloatArray
    normals: FloatArray


def project(points: FloatArray, corners: FloatArray, normals: FloatArray) -> ClosestPoints:
    """Return the closest points of a surface to points.

    Args:
        points: shape (n, dimension).
        corners: of the facets, at least one, shape (facets, corners, dimension).
        normals: of the facets, shape (facets, dimension).
    """
    centres = corners.mean(axis=1)
    radius = float(np.linalg.norm(corners - centres[:, None], axis=2).max())
    tree = cKDTree(centres)
    nearest = tree.query(points)[1]
    reach = _closest(points, corners[nearest])[1]
    lists = tree.query_ball_point(points, reach + radius * (1 + EQUAL))
    count = np.array([len(found) for found in lists], dtype=np.int64)
    point = np.repeat(np.arange(len(points)), count)
    facet = np.concatenate([np.zeros(0, dtype=np.int64), *lists]).astype(np.int64)
    weights, distance = _closest(points[point], corners[facet])
    smallest = np.full(len(points), np.inf)
    np.minimum.at(smallest, point, distance)
    equal = distance <= smallest[point] + EQUAL * radius
    means = np.zeros_like(points)
    np.add.at(means, point[equal], normals[facet[equal]])
    # Of equally close facets the one with the lowest number.
    order = np.lexsort((facet, ~equal, point))
    first = order[np.searchsorted(point[order], np.arange(len(points)))]
    lengths = np.linalg.norm(means, axis=1, keepdims=True)
    means = np.divide(means, lengths, out=normals[facet[first]].copy(), where=lengths > 0)
    return ClosestPoints(facet[first], weights[first], means)


def _closest(points: FloatArray, corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return weights of the corners and the distance of one facet for each point."""
    count = corners.shape[1]
    if count == 2:
        return _on_lines(points, corners)
    if count == 3:
        return _on_triangles(points, corners)
    best_weights = np.zeros(corners.shape[:2])
    best = np.full(len(points), np.inf)
    for half in HALVES:
        weights, distance = _on_triangles(points, corners[:, half])
        closer = distance < best
        best_weights[closer] = 0.0
        best_weights[np.ix_(np.flatnonzero(closer), np.array(half))] = weights[closer]
        best = np.minimum(best, distance)
    return best_weights, best


def _on_lines(points: FloatArray, corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    start, along = corners[:, 0], corners[:, 1] - corners[:, 0]
    part = np.sum((points - start) * along, axis=1) / np.sum(along**2, axis=1)
    part = np.clip(part, 0.0, 1.0)
    distance = np.linalg.norm(points - start - part[:, None] * along, axis=1)
    return np.stack((1.0 - part, part), axis=1), distance


def _on_triangles(points: FloatArray, corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    origin = corners[:, 0]
    edges = corners[:, 1:] - origin[:, None]
    gram = edges @ edges.transpose(0, 2, 1)
    right = np.einsum("nij,nj->ni", edges, points - origin)
    inner = np.linalg.solve(gram, right[:, :, None])[:, :, 0]
    weights = np.concatenate((1.0 - inner.sum(axis=1, keepdims=True), inner), axis=1)
    distance = _distance(points, corners, weights)
    outside = np.any(weights < 0.0, axis=1)
    distance[outside] = np.inf
    for a, b in ((0, 1), (1, 2), (2, 0)):
        on_edge, away = _on_lines(points, corners[:, (a, b)])
        closer = outside & (away < distance)
        weights[closer] = 0.0
        weights[np.ix_(np.flatnonzero(closer), np.array((a, b)))] = on_edge[closer]
        distance[closer] = away[closer]
    return weights, distance


def _distance(points: FloatArray, corners: FloatArray, weights: FloatArray) -> FloatArray:
    reached = np.einsum("na,nak->nk", weights, corners)
    return np.asarray(np.linalg.norm(points - reached, axis=1))
