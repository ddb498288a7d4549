"""Shares of pairs from node to face in the edges of the body that they face.

Where displacements are quadratic a pressure acts on the bubble b of an edge along ∫ b n dS. Each
point of the primary surface passes its part to the nodes of the facet that it faces, by their shape
functions φ there,

    m_ie = ∫ b_e φ_i n dS,  Σ_i m_ie = ∫ b_e n dS  over what faces the secondary surface,

so that a uniform pressure crosses meshes that do not match exactly, and m_ie/S_i weights the motion
of the bubbles round a node by the area that it has in front of them. The points are those of a
quadrature on parts of a facet that are no larger than half of the facets opposite.

Source: C. Bernardi, Y. Maday and A. T. Patera (1994), A new nonconforming approach to domain
decomposition: the mortar element method; here of bubbles alone.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.case.contact import Pairing
from castx.domain.cell_kinds import CellKind
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.edge_shares import EdgeShares, weighted_points
from castx.domain.pairs.facet_pairs import FacetPairs, sums_by_number
from castx.domain.pairs.facing import SurfacePoints, faced, facet_sizes
from castx.domain.pairs.node_pairs import NodePairs
from castx.domain.pairs.sharing import FACING
from castx.domain.surface_facets import SurfaceFacets, surface_facets

DEGREE = 4
"""Of the quadrature on each part of a facet: exact for a bubble, a radius and a shape function."""

MOST_PARTS = 4
"""Of each edge of a facet, however much finer the surface opposite is."""


class FacingEdges(NamedTuple):
    """The edges of the primary surface of an interface from node to face.

    Attributes:
        shares: of the pairs of this rank in them.
        touching: global nodes of the primary body at the ends of the edges of all ranks of whose
            bubble at least half faces the secondary surface, shape (n, 2).
    """

    shares: EdgeShares
    touching: LongArray


def facing_edges(
    mesh: CastingMesh, found: FacetPairs, pairs: NodePairs, rule: Pairing
) -> FacingEdges:
    """Return the edges of the primary surface with the shares of the pairs in them; collective.

    Args:
        mesh: mesh of the bodies.
        found: facets of the secondary surface, with the pairs.
        pairs: from node to face.
        rule: of the pairs.
    """
    name = (rule.surfaces or (pairs.primary, pairs.secondary))[1]
    facets = surface_facets(mesh, mesh.bodies[pairs.primary], name)
    points = _points(mesh, facets, found, rule.search_distance)
    corners: LongArray = facets.kind.faces if facets.kind.dimension == 2 else np.array([[0, 1]])
    ends, edge = np.unique(
        np.sort(facets.nodes[:, corners].reshape(-1, 2), axis=1), axis=0, return_inverse=True
    )
    edge = edge.reshape(len(facets.nodes), -1)[points.facet]
    # Parts of the points in the area of the bubble of each edge of their facet.
    shapes = points.shapes[:, corners]
    areas = points.areas[:, None] * 4 * shapes[:, :, 0] * shapes[:, :, 1]
    whole, faces = (
        np.bincount(edge.ravel(), (areas * part).ravel(), len(ends))
        for part in (1.0, points.parts.sum(axis=1, keepdims=True))
    )
    count = int(found.labels.max(initial=-1)) + 1
    number = edge[:, :, None] * count + points.labels[:, None]
    vectors = (areas[:, :, None] * points.parts[:, None])[:, :, :, None]
    vectors = vectors * facets.normals[points.facet][:, None, None]
    keys, place = np.unique(number.ravel(), return_inverse=True)
    summed = sums_by_number(place.ravel(), vectors.reshape(-1, facets.normals.shape[1]), len(keys))
    size, pair = np.linalg.norm(summed, axis=1), found.pairs[keys % count]
    mine = np.flatnonzero((pair >= 0) & (size > 0))
    shares = EdgeShares(
        pair[mine].astype(np.int32), ends[keys[mine] // count], size[mine],
        summed[mine] / size[mine, None],
    )  # fmt: skip
    return FacingEdges(shares, ends[2 * faces >= whole])


class _Points(NamedTuple):
    """Points of a primary surface, and the corners of the secondary facets that they face.

    Attributes:
        facet: on which they lie, shape (n,).
        shapes: shape functions of its corners there, shape (n, corners).
        areas: of the points [m²], shape (n,).
        labels: of the corners of the facet opposite, shape (n, corners).
        parts: of these in what the point bears, zero where it faces none, shape (n, corners).
    """

    facet: LongArray
    shapes: FloatArray
    areas: FloatArray
    labels: LongArray
    parts: FloatArray


def _points(
    mesh: CastingMesh, facets: SurfaceFacets, found: FacetPairs, reach: float | None
) -> _Points:
    """Return the points of a quadrature on the facets of a primary surface; collective."""
    places, weights = _parts(facets.kind, _count(facets, found.facets))
    shapes, points, areas = weighted_points(facets, mesh.model, places, weights)
    facet = np.repeat(np.arange(len(points)), len(places))
    outward, sizes = facets.normals[facet], facet_sizes(facets)[facet]
    given = SurfacePoints(points.reshape(-1, points.shape[2]), outward, sizes)
    opposite, distance = faced(given, found.facets, reach, FACING)
    labels = found.labels[opposite.facet]
    # What a corner without a pair would bear goes to the others.
    parts = opposite.weights * _with_pairs(mesh, found)[labels] * np.isfinite(distance)[:, None]
    total = parts.sum(axis=1, keepdims=True)
    parts = np.divide(parts, total, out=np.zeros_like(parts), where=total > 0)
    return _Points(facet, np.tile(shapes, (len(points), 1)), areas.ravel(), labels, parts)


def _with_pairs(mesh: CastingMesh, found: FacetPairs) -> BoolArray:
    """Return a mask of the labels of an interface that have a pair on any rank; collective."""
    return np.asarray(np.any(mesh.comm.allgather(found.pairs >= 0), axis=0))


def _count(facets: SurfaceFacets, opposite: SurfaceFacets) -> int:
    """Return into how many parts the edges of facets are divided."""
    ratio = 2 * np.median(facet_sizes(facets)) / np.median(facet_sizes(opposite))
    return int(np.clip(np.ceil(ratio - 1e-6), 1, MOST_PARTS))


def _parts(kind: CellKind, count: int) -> tuple[FloatArray, FloatArray]:
    """Return points and weights of a quadrature on equal parts of a line or a triangle."""
    places, weights = kind.quadrature(DEGREE)
    corners = np.indices((count,) * kind.dimension).reshape(kind.dimension, -1).T
    found = [(corner + places) / count for corner in corners if corner.sum() < count]
    # The triangles between those stand on their heads.
    found += [
        (corner + 1 - places) / count
        for corner in corners
        if kind.dimension == 2 and corner.sum() < count - 1
    ]
    return np.concatenate(found), np.tile(weights / count**kind.dimension, len(found))
