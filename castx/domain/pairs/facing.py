"""Points of a surface that face another surface, and their distances."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.domain.pairs.closest_point import ClosestPoints, project
from castx.domain.surface_facets import SurfaceFacets

OVERHANG = 0.05
"""Distance beside the edge of a surface beyond which a point faces nothing, in sizes of a facet.

The rims of curved surfaces with a gap between them are never quite opposite each other."""


class SurfacePoints(NamedTuple):
    """Points of a surface.

    Attributes:
        places: shape (n, dimension) [m].
        outward: unit normals, shape (n, dimension).
        sizes: of the mesh at the points [m], shape (n,).
    """

    places: FloatArray
    outward: FloatArray
    sizes: FloatArray


class Faced(NamedTuple):
    """Closest points of a surface that points face, and their distances.

    Attributes:
        found: the closest point of the surface to each point.
        distance: to it [m], infinite where a point does not face it, shape (n,).
    """

    found: ClosestPoints
    distance: FloatArray


def faced(
    points: SurfacePoints,
    facets: SurfaceFacets,
    search_distance: float | None,
    least_opposite: float = 0.0,
) -> Faced:
    """Project points of one surface onto the facets of another.

    Args:
        points: of the one surface.
        facets: of the other one, at least one facet.
        search_distance: beyond which a point faces nothing [m]; None: the size of the mesh there,
            on that side where it is coarser.
        least_opposite: opposite normals have a cosine below its negative.
    """
    found = project(points.places, facets.points, facets.normals)
    reached = np.einsum("na,nak->nk", found.weights, facets.points[found.facet])
    distance = np.linalg.norm(points.places - reached, axis=1)
    facing = _opposite(points.places, found, facets)
    facing &= np.sum(points.outward * found.normals, axis=1) < -least_opposite
    if search_distance is None:
        facing &= distance <= np.maximum(points.sizes, facet_sizes(facets)[found.facet])
    else:
        facing &= distance <= search_distance
    return Faced(found, np.where(facing, distance, np.inf))


def facet_sizes(facets: SurfaceFacets) -> FloatArray:
    """Return the longest distance of two corners of each facet [m], shape (facets,)."""
    apart = facets.points[:, :, None] - facets.points[:, None, :]
    return np.asarray(np.linalg.norm(apart, axis=3).max(axis=(1, 2), initial=0.0))


def _opposite(points: FloatArray, found: ClosestPoints, facets: SurfaceFacets) -> BoolArray:
    """Return a mask of the points opposite a facet, not beside the edge of the surface."""
    corners = facets.points[found.facet]
    reached = np.einsum("na,nak->nk", found.weights, corners)
    normal = facets.normals[found.facet]
    offset = points - reached
    beside = offset - np.sum(offset * normal, axis=1, keepdims=True) * normal
    size = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2).max(axis=1)
    far = np.linalg.norm(beside, axis=1) > OVERHANG * size
    return np.asarray(~(far & _at_edge(found, facets)))


def _at_edge(found: ClosestPoints, facets: SurfaceFacets) -> BoolArray:
    """Return a mask of the closest points on the edge of the surface."""
    count = facets.nodes.shape[1]
    local = facets.kind.faces
    keys = np.sort(facets.nodes[:, local], axis=2)
    flat = keys.reshape(-1, keys.shape[2])
    number, times = np.unique(flat, axis=0, return_inverse=True, return_counts=True)[1:]
    single = (times[number.ravel()] == 1).reshape(keys.shape[:2])
    at_edge = np.zeros(len(found.facet), dtype=bool)
    used = found.weights > 0
    rim = np.unique(facets.nodes[:, local][single])
    for k, side in enumerate(local):
        others = np.setdiff1d(np.arange(count), side)
        at_edge |= single[found.facet, k] & ~used[:, others].any(axis=1)
    alone = used.sum(axis=1) == 1
    corner = facets.nodes[found.facet, np.argmax(found.weights, axis=1)]
    return np.asarray(at_edge | (alone & np.isin(corner, rim)))
