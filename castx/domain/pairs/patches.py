"""Pairs for each smooth patch of an interface at edges and corners (Chiumenti, section 5).

The facets round a node belong to one patch as long as neighbours enclose less than the sharp angle.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from castx.arrays import LongArray
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.node_pairs import NodePairs, check_shared, pairs_at
from castx.domain.surface_facets import SurfaceFacets, surface_facets


def pairs_by_patch(
    mesh: CastingMesh, secondary: str, primary: str, sharp_angle: float
) -> NodePairs:
    """Return a pair for each smooth patch round a node, the largest patch first; collective.

    Args:
        mesh: mesh of the bodies.
        secondary: name of the body whose nodes carry the pairs.
        primary: name of the other body.
        sharp_angle: between the normals of neighbouring facets of different patches [rad].

    Raises:
        MeshError: the bodies share no surface, or the normals of a patch cancel; on all ranks.
    """
    body = mesh.bodies[secondary]
    check_shared(body, primary)
    facets = surface_facets(mesh, body, primary)
    patch = corner_patches(facets, sharp_angle)
    count = int(patch.max(initial=-1)) + 1
    areas = np.bincount(patch, facets.areas.ravel(), count)
    vectors = np.stack(
        [np.bincount(patch, v.ravel(), count) for v in np.moveaxis(facets.vectors, 2, 0)], axis=1
    )
    nodes = np.zeros(count, dtype=np.int64)
    nodes[patch] = facets.nodes.ravel()
    low, high = body.nodes.dofmap.index_map.local_range
    # Equal areas are ordered by direction, so that the order does not depend on the ranks.
    directions = np.round(vectors / areas[:, None], 9)
    size = np.round(areas / areas.max(initial=0.0), 9)
    order = np.lexsort((*directions.T, -size, nodes))
    mine = order[(nodes[order] >= low) & (nodes[order] < high)]
    local = (nodes[mine] - low).astype(np.int32)
    return pairs_at(mesh, secondary, primary, local, areas[mine], vectors[mine])


def corner_patches(facets: SurfaceFacets, sharp_angle: float) -> LongArray:
    """Return the patch of each corner of each facet as a number, shape (facets * corners,).

    Corners of one patch lie at one node.

    Args:
        facets: of the interface.
        sharp_angle: between the normals of neighbouring facets of different patches [rad].
    """
    count, corners = facets.nodes.shape
    items = np.arange(count * corners).reshape(count, corners)
    rows, columns = _smooth_links(facets, items, sharp_angle)
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(items.size, items.size))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _smooth_links(
    facets: SurfaceFacets, items: LongArray, sharp_angle: float
) -> LongArray:
    """Return pairs of corners at one node whose facets are smooth neighbours, shape (2, links)."""
    local = facets.kind.faces  # corners of a line, edges of a polygon
    given = facets.nodes[:, local].reshape(-1, local.shape[1])
    # The same node first on both facets of a side.
    within = np.argsort(given, axis=1)
    nodes = np.take_along_axis(given, within, axis=1)
    corner = np.take_along_axis(items[:, local].reshape(given.shape), within, axis=1)
    facet = np.repeat(np.arange(len(items)), len(local))
    keys = np.unique(nodes, axis=0, return_inverse=True)[1].ravel()
    order = np.argsort(keys, kind="stable")
    same = keys[order][1:] == keys[order][:-1]
    first, second = order[:-1][same], order[1:][same]
    cosine = np.sum(facets.normals[facet[first]] * facets.normals[facet[second]], axis=1)
    smooth = cosine > np.cos(sharp_angle)
    return np.stack((corner[first][smooth].ravel(), corner[second][smooth].ravel()))
