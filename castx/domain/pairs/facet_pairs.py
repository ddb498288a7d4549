"""The facets round the pairs of an interface, and which pair is at each of their corners."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from castx.arrays import FloatArray, LongArray
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.node_pairs import NodePairs
from castx.domain.pairs.patches import corner_patches
from castx.domain.surface_facets import SurfaceFacets, surface_facets


@dataclass(frozen=True)
class FacetPairs:
    """Facets of all ranks of the secondary side of an interface, with the pairs of this rank.

    Attributes:
        facets: of the secondary surface.
        labels: a number for each corner of each facet, the same within a pair, shape (facets,
            corners).
        pairs: of the labels, -1 where it is on another rank or where nothing faces it, shape
            (labels,).
    """

    facets: SurfaceFacets
    labels: LongArray
    pairs: LongArray


def facet_pairs(mesh: CastingMesh, pairs: NodePairs, sharp_angle: float | None) -> FacetPairs:
    """Return the facets of an interface with its pairs; collective.

    Args:
        mesh: mesh of the bodies.
        pairs: of the interface.
        sharp_angle: between the facets of different patches, each of which has a pair [rad]; None:
            each node has one pair.
    """
    facets = surface_facets(mesh, mesh.bodies[pairs.secondary], pairs.surface)
    labels = _labels(facets, sharp_angle)
    return FacetPairs(facets, labels, _pairs_of_labels(facets, labels, pairs))


def sums_by_number(number: LongArray, values: FloatArray, count: int) -> FloatArray:
    """Return sums of rows by a number of each, shape (count, columns)."""
    return np.stack([np.bincount(number, column, count) for column in values.T], axis=1)


def _labels(facets: SurfaceFacets, sharp_angle: float | None) -> LongArray:
    if sharp_angle is None:
        found = np.unique(facets.nodes, return_inverse=True)[1]
    else:
        found = corner_patches(facets, sharp_angle)
    return np.asarray(found, dtype=np.int64).reshape(facets.nodes.shape)


def _pairs_of_labels(facets: SurfaceFacets, labels: LongArray, pairs: NodePairs) -> LongArray:
    """Return the pair of this rank of each label, -1 where there is none."""
    count = int(labels.max(initial=-1)) + 1
    node = np.zeros(count, dtype=np.int64)
    node[labels.ravel()] = facets.nodes.ravel()
    dimension = facets.vectors.shape[2]
    vectors = sums_by_number(labels.ravel(), facets.vectors.reshape(-1, dimension), count)
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
