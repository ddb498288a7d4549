"""What the edges of an interface have of its pairs, where displacements are quadratic.

Between the ends of an edge a displacement has the bubble b = 4 φ_a φ_b beside what is linear. A
pressure acts on it along the area vector ∫ b n dS of the edge, two thirds of the length of a line
and a third of each triangle beside it, which its two ends share. A share α is such that both ends
together lie where the edge does,

    α_a x_a + α_b x_b = x_e,  α_a + α_b = 1,  x_i = ∫ φ_i x dS/∫ φ_i dS,  x_e = ∫ b x dS/∫ b dS,

along the edge: half of it, but at the rim of the interface, whose node stands for what lies beside
it. So pairs carry every uniform pressure exactly, and on lines one that is linear along them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from castx.arrays import FloatArray, IntArray, LongArray
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.node_pairs import NodePairs
from castx.domain.pairs.patches import corner_patches
from castx.domain.surface_facets import SurfaceFacets, surface_facets

DEGREE = 4
"""Of the quadrature: exact for a bubble times a place times a radius."""


@dataclass(frozen=True)
class EdgeShares:
    """Shares of the pairs of this rank in the edges of their interface.

    Attributes:
        pair: numbers of pairs, shape (n,).
        ends: global nodes of the secondary body at the ends of an edge, shape (n, 2).
        vectors: α ∫ b n dS of the edge, n the outward normal of the primary body [m²], shape
            (n, dimension).
    """

    pair: IntArray
    ends: LongArray
    vectors: FloatArray


def edge_shares(mesh: CastingMesh, pairs: NodePairs, sharp_angle: float | None) -> EdgeShares:
    """Return the shares of pairs in the edges of their interface; collective.

    Args:
        mesh: mesh of the bodies.
        pairs: of the interface, whose facets are lines or triangles.
        sharp_angle: between the facets of different patches, each of which has a pair [rad]; None:
            each node has one pair.
    """
    facets = surface_facets(mesh, mesh.bodies[pairs.secondary], pairs.surface)
    labels = _labels(facets, sharp_angle)
    edges = _edges(facets, labels, mesh.model)
    found = _pairs_of_labels(facets, labels, pairs)[edges.labels]
    edge, end = np.nonzero(found >= 0)
    pair = found[edge, end]
    # A node may have a part of its area in each of several interfaces.
    areas = np.bincount(labels.ravel(), facets.areas.ravel())[edges.labels[edge, end]]
    shares = edges.shares[edge, end] * pairs.areas[pair] / areas
    vectors = -shares[:, None] * edges.vectors[edge]
    return EdgeShares(pair.astype(np.int32), edges.nodes[edge], vectors)


@dataclass(frozen=True)
class _Edges:
    """Edges of the facets of one patch.

    Attributes:
        labels: of both ends, shape (edges, 2).
        nodes: global nodes at both ends, shape (edges, 2).
        vectors: ∫ b n dS, n outward [m²], shape (edges, dimension).
        shares: α of both ends, shape (edges, 2).
    """

    labels: LongArray
    nodes: LongArray
    vectors: FloatArray
    shares: FloatArray


def _labels(facets: SurfaceFacets, sharp_angle: float | None) -> LongArray:
    """Return a number for each corner of each facet, the same within a pair, (facets, corners)."""
    if sharp_angle is None:
        found = np.unique(facets.nodes, return_inverse=True)[1]
    else:
        found = corner_patches(facets, sharp_angle)
    return np.asarray(found, dtype=np.int64).reshape(facets.nodes.shape)


def _edges(facets: SurfaceFacets, labels: LongArray, model: str) -> _Edges:
    corners = facets.kind.faces if facets.kind.dimension == 2 else np.array([[0, 1]])
    # Both ends in the order of their labels, and an edge between two facets of a patch once.
    given = labels[:, corners].reshape(-1, 2)
    order = np.argsort(given, axis=1)
    nodes = np.take_along_axis(facets.nodes[:, corners].reshape(-1, 2), order, axis=1)
    given = np.take_along_axis(given, order, axis=1)
    ends, place, edge = np.unique(given, axis=0, return_index=True, return_inverse=True)
    edge, normals = edge.ravel(), np.repeat(facets.normals, len(corners), axis=0)

    def bubbles(shapes: FloatArray) -> FloatArray:
        return 4 * shapes[:, corners[:, 0]] * shapes[:, corners[:, 1]]

    areas, moments = _integrals(facets, model, bubbles)
    middles = _sums(edge, moments, len(ends)) / _sums(edge, areas, len(ends))
    areas_there, moments_there = _integrals(facets, model, lambda shapes: shapes)
    count, corner = int(labels.max(initial=-1)) + 1, labels.ravel()
    at_ends = (_sums(corner, moments_there, count) / _sums(corner, areas_there, count))[ends]
    along = at_ends[:, 1] - at_ends[:, 0]
    second = np.sum((middles - at_ends[:, 0]) * along, axis=1) / np.sum(along**2, axis=1)
    second = np.clip(second, 0.0, 1.0)
    vectors = _sums(edge, areas * normals, len(ends))
    return _Edges(ends, nodes[place], vectors, np.stack((1.0 - second, second), axis=1))


def _integrals(
    facets: SurfaceFacets, model: str, functions: Callable[[FloatArray], FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """Return ∫ f dS and ∫ f x dS of functions f of flat facets, (facets functions, 1 and dimension).

    Args:
        facets: of the interface.
        model: geometric model.
        functions: returns their values from those of the corners' shape functions, both of shape
            (points, functions).
    """
    places, weights = facets.kind.quadrature(DEGREE)
    shapes = facets.kind.shape_functions(places)[0]
    points = np.einsum("qa,fad->fqd", shapes, facets.points)
    weight = weights * points[:, :, 0] if model == "axisymmetric" else np.tile(weights, (len(points), 1))
    weight = weight * (facets.areas.sum(axis=1) / weight.sum(axis=1))[:, None]
    values = functions(shapes)
    areas = np.einsum("fq,qe->fe", weight, values)
    moments = np.einsum("fq,qe,fqd->fed", weight, values, points)
    return areas.reshape(-1, 1), moments.reshape(-1, points.shape[2])


def _sums(number: LongArray, values: FloatArray, count: int) -> FloatArray:
    """Return sums of rows by a number of each, shape (count, columns)."""
    return np.stack([np.bincount(number, column, count) for column in values.T], axis=1)


def _pairs_of_labels(facets: SurfaceFacets, labels: LongArray, pairs: NodePairs) -> LongArray:
    """Return the pair of this rank of each label, -1 where it is on another rank."""
    count = int(labels.max(initial=-1)) + 1
    node = np.zeros(count, dtype=np.int64)
    node[labels.ravel()] = facets.nodes.ravel()
    dimension = facets.vectors.shape[2]
    vectors = _sums(labels.ravel(), facets.vectors.reshape(-1, dimension), count)
    found = np.full(count, -1, dtype=np.int64)
    if len(pairs.areas) == 0:
        return found
    # Pairs of one node differ by their normals, by 2 at most.
    normals = -vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    own = np.column_stack((5.0 * pairs.secondary_nodes, pairs.normals))
    distance, nearest = cKDTree(own).query(np.column_stack((5.0 * node, normals)))
    here = distance < 2.5
    found[here] = nearest[here]
    return found
