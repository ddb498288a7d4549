"""Shares of pairs in the edges of their interface, where displacements are quadratic.

Between the ends of an edge a displacement has the bubble b = 4 φ_a φ_b beside what is linear. A
pressure acts on it along the area vector ∫ b n dS of the edge, two thirds of the length of a line
and a third of each triangle beside it. The nodes of these facets share it, by such shares α that
they lie in the mean where the bubble does along the surface,

    Σ α_i = 1,  Σ α_i x_i = x_e,  x_i = ∫ φ_i x dS/∫ φ_i dS,  x_e = ∫ b x dS/∫ b dS,

and are as near as they can to a half for both ends and nothing for the others. So the pairs carry
every pressure exactly that is linear along a flat surface, as that of a melt at rest is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray, IntArray, LongArray
from castx.domain.pairs.facet_pairs import FacetPairs, sums_by_number
from castx.domain.pairs.node_pairs import NodePairs
from castx.domain.surface_facets import SurfaceFacets

DEGREE = 4
"""Of the quadrature: exact for a bubble times a place times a radius."""

DEPENDENT = 1e-6
"""Part of the largest singular value below which a condition follows from the others."""


@dataclass(frozen=True)
class EdgeShares:
    """Shares of the pairs of this rank in the edges of their interface.

    Attributes:
        pair: numbers of pairs, shape (n,).
        ends: global nodes of the secondary body at the ends of an edge, shape (n, 2).
        areas: α |∫ b n dS| of the edge, of some nodes across it negative [m²], shape (n,).
        normals: unit vectors along ∫ b n dS, n the outward normal of the primary body, shape
            (n, dimension).
    """

    pair: IntArray
    ends: LongArray
    areas: FloatArray
    normals: FloatArray


def edge_shares(found: FacetPairs, pairs: NodePairs, model: str) -> EdgeShares:
    """Return the shares of pairs in the edges of their interface.

    Args:
        found: facets of the interface, lines or triangles, with its pairs.
        pairs: of the interface.
        model: geometric model.
    """
    facets, labels = found.facets, found.labels
    edges = _edges(facets, labels, model)
    # Behind the last label nothing is, so that -1 has no pair.
    pair_at = np.append(found.pairs, -1)[edges.labels]
    edge, node = np.nonzero(pair_at >= 0)
    pair = pair_at[edge, node]
    # A node may have a part of its area in each of several interfaces.
    areas = np.bincount(labels.ravel(), facets.areas.ravel())[edges.labels[edge, node]]
    shares = edges.shares[edge, node] * pairs.areas[pair] / areas
    size = np.linalg.norm(edges.vectors, axis=1)
    normals = -edges.vectors / size[:, None]
    return EdgeShares(pair.astype(np.int32), edges.nodes[edge], shares * size[edge], normals[edge])


@dataclass(frozen=True)
class _Edges:
    """Edges of the facets of one patch.

    Attributes:
        labels: of the nodes of its facets, both ends first, -1 where there are fewer, shape
            (edges, most).
        nodes: global nodes at both ends, shape (edges, 2).
        vectors: ∫ b n dS, n outward [m²], shape (edges, dimension).
        shares: α of the labels, shape (edges, most).
    """

    labels: LongArray
    nodes: LongArray
    vectors: FloatArray
    shares: FloatArray


def _edges(facets: SurfaceFacets, labels: LongArray, model: str) -> _Edges:
    plane = facets.kind.dimension == 2
    corners: LongArray = facets.kind.faces if plane else np.array([[0, 1]])
    # Both ends in the order of their labels, and an edge between two facets of a patch once.
    given = labels[:, corners].reshape(-1, 2)
    order = np.argsort(given, axis=1)
    nodes = np.take_along_axis(facets.nodes[:, corners].reshape(-1, 2), order, axis=1)
    sorted_ends = np.take_along_axis(given, order, axis=1)
    ends, place, edge = np.unique(sorted_ends, axis=0, return_index=True, return_inverse=True)
    edge, normals = edge.ravel(), np.repeat(facets.normals, len(corners), axis=0)

    def bubbles(shapes: FloatArray) -> FloatArray:
        return 4 * shapes[:, corners[:, 0]] * shapes[:, corners[:, 1]]

    areas, moments = _integrals(facets, model, bubbles)
    vectors = sums_by_number(edge, areas * normals, len(ends))
    middles = sums_by_number(edge, moments, len(ends)) / sums_by_number(edge, areas, len(ends))
    areas, moments = _integrals(facets, model, lambda shapes: shapes)
    count, corner = int(labels.max(initial=-1)) + 1, labels.ravel()
    centres = sums_by_number(corner, moments, count) / sums_by_number(corner, areas, count)
    if plane:
        across = labels[:, 3 - corners.sum(axis=1)].ravel()
        ends = np.column_stack((ends, _of_both_facets(edge, across, len(ends))))
    return _Edges(ends, nodes[place], vectors, _shares(ends, centres, middles, vectors))


def _of_both_facets(edge: LongArray, across: LongArray, count: int) -> LongArray:
    """Return the labels across edges in their one or two facets, -1 for none, (edges, 2)."""
    found = np.full((count, 2), -1, dtype=np.int64)
    found[edge, 0] = across
    other = np.flatnonzero(found[edge, 0] != across)
    found[edge[other], 1] = across[other]
    return found


def _shares(
    labels: LongArray, centres: FloatArray, middles: FloatArray, vectors: FloatArray
) -> FloatArray:
    """Return the shares α of nodes in edges, shape (edges, most).

    Args:
        labels: of the nodes of each edge, both ends first, -1 for none, shape (edges, most).
        centres: x_i of the labels [m], shape (labels, dimension).
        middles: x_e [m], shape (edges, dimension).
        vectors: normal to the surface, shape (edges, dimension).
    """
    normals = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    apart = centres[labels] - middles[:, None]
    along = apart - np.einsum("enk,ek->en", apart, normals)[:, :, None] * normals[:, None]
    along /= np.linalg.norm(along[:, 0] - along[:, 1], axis=1)[:, None, None]
    there = labels >= 0
    ones = np.ones((*labels.shape, 1))
    conditions = np.concatenate((ones, along), axis=2) * there[:, :, None]
    start = np.zeros(labels.shape)
    start[:, :2] = 0.5
    missing = -np.einsum("enk,en->ek", conditions, start)
    missing[:, 0] += 1.0
    inverse = np.linalg.pinv(conditions.transpose(0, 2, 1), rcond=DEPENDENT)
    shares = start + np.einsum("enk,ek->en", inverse, missing)
    return np.asarray(shares / shares.sum(axis=1, keepdims=True))


def weighted_points(
    facets: SurfaceFacets, model: str, places: FloatArray, weights: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the points of a quadrature on flat facets.

    Args:
        facets: of a surface.
        model: geometric model.
        places: of the points in the reference facet, shape (points, dimension).
        weights: of them there, shape (points,).

    Returns:
        Shape functions of the corners (points, corners), places [m] (facets, points, dimension) and
        areas [m²] (facets, points), of the full turn when axisymmetric.
    """
    shapes = facets.kind.shape_functions(places)[0]
    points = np.einsum("qa,fad->fqd", shapes, facets.points)
    weight = (
        weights * points[:, :, 0] if model == "axisymmetric" else np.tile(weights, (len(points), 1))
    )
    return shapes, points, weight * (facets.areas.sum(axis=1) / weight.sum(axis=1))[:, None]


def _integrals(
    facets: SurfaceFacets, model: str, functions: Callable[[FloatArray], FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """Return ∫ f dS and ∫ f x dS of functions f of flat facets, in rows, facet after facet.

    Args:
        facets: of the interface.
        model: geometric model.
        functions: returns their values from those of the corners' shape functions, both of shape
            (points, functions).
    """
    rule = facets.kind.quadrature(DEGREE)
    shapes, points, weight = weighted_points(facets, model, *rule)
    values = functions(shapes)
    areas = np.einsum("fq,qe->fe", weight, values)
    moments = np.einsum("fq,qe,fqd->fed", weight, values, points)
    return areas.reshape(-1, 1), moments.reshape(-1, points.shape[2])
