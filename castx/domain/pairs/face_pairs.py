"""Nodes of one body that face the facets of another, for surfaces whose meshes do not match.

Each node is projected once onto the closest point of the other surface: displacements are small.
The force of a node acts on the corners of its facet by the shape functions there. These forces are
those of a uniform pressure only if every facet is divided evenly: elsewhere forces balance, but the
patch test fails (Taylor and Papadopoulos 1991), and single pressures too, however fine the mesh.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.case.contact import Pairing
from castx.domain.measures import nodal_area_vectors, nodal_areas
from castx.domain.mesh import BodyMesh, CastingMesh
from castx.domain.pairs.closest_point import ClosestPoints, project
from castx.domain.pairs.node_pairs import NodePairs
from castx.domain.surface_facets import SurfaceFacets, surface_facets
from castx.errors import MeshError

OVERHANG = 0.05
"""Distance beside the edge of a surface beyond which a node faces nothing, in sizes of a facet.

The rims of curved surfaces with a gap between them are never quite opposite each other."""


def face_pairs(
    mesh: CastingMesh, secondary: str, primary: str, rule: Pairing
) -> NodePairs:
    """Return pairs of the nodes of a surface with the facets that they face; collective.

    Args:
        mesh: mesh of the bodies.
        secondary: name of the body whose nodes carry the pairs.
        primary: name of the other body.
        rule: names of surfaces, normals, and whether the distance of the meshes counts.

    Raises:
        MeshError: a surface is missing, or nothing faces the other one; on all ranks.
    """
    own, other = mesh.bodies[secondary], mesh.bodies[primary]
    name, facing = rule.surfaces or (primary, secondary)
    if rule.surfaces is None and primary not in own.surfaces:
        raise MeshError(
            f"the bodies {secondary!r} and {primary!r} share no surface: name those that face each "
            'other, contact = { pairing = "node-to-face", surfaces = ["of the first", "of the '
            'second"] }'
        )
    local = own.surface_nodes(name)
    local = local[local < own.nodes.dofmap.index_map.size_local]
    areas = nodal_areas(own, mesh.model, name)
    vectors = nodal_area_vectors(own, mesh.model, name)
    facets = surface_facets(mesh, other, facing)
    if len(facets.nodes) == 0:
        raise MeshError(f"surface {facing!r} of body {primary!r} has no facets")
    points = own.points[local]
    found = project(points, facets.points, facets.normals)
    lengths = np.linalg.norm(vectors[local], axis=1, keepdims=True)
    outward = vectors[local] / np.where(lengths > 0, lengths, 1.0)
    kept = _opposite(points, found, facets) & (np.sum(outward * found.normals, axis=1) < 0)
    if mesh.comm.allreduce(int(np.count_nonzero(kept))) == 0:
        raise MeshError(
            f"no node of {secondary}/{name} faces {primary}/{facing}; both surfaces must lie "
            "opposite each other"
        )
    normal = found.normals if rule.normals == "primary" else _unit(found.normals - outward)
    pairs = _pairs(own, (secondary, primary, name), facets, found, (local, areas, normal), kept)
    return pairs if rule.meshed_gap else replace(pairs, distances=None)


def _unit(vectors: FloatArray) -> FloatArray:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.where(lengths > 0, lengths, 1.0))


def _opposite(points: FloatArray, found: ClosestPoints, facets: SurfaceFacets) -> BoolArray:
    """Return which points lie opposite a facet, not beside the edge of the surface."""
    corners = facets.points[found.facet]
    reached = np.einsum("na,nak->nk", found.weights, corners)
    normal = facets.normals[found.facet]
    offset = points - reached
    beside = offset - np.sum(offset * normal, axis=1, keepdims=True) * normal
    size = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2).max(axis=1)
    far = np.linalg.norm(beside, axis=1) > OVERHANG * size
    return ~(far & _at_edge(found, facets))


def _at_edge(found: ClosestPoints, facets: SurfaceFacets) -> BoolArray:
    """Return which closest points lie on the edge of the surface."""
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


def _pairs(
    own: BodyMesh,
    names: tuple[str, str, str],
    facets: SurfaceFacets,
    found: ClosestPoints,
    nodes: tuple[IntArray, FloatArray, FloatArray],
    kept: BoolArray,
) -> NodePairs:
    local, areas, normals = nodes
    chosen, facet, weights = local[kept], found.facet[kept], found.weights[kept]
    faces = facets.nodes[facet]
    reached = np.einsum("na,nak->nk", weights, facets.points[facet])
    n = normals[kept]
    nearest = np.take_along_axis(faces, np.argmax(weights, axis=1)[:, None], axis=1)[:, 0]
    secondary, primary, surface = names
    return NodePairs(
        secondary,
        primary,
        own.nodes.dofmap.index_map.local_to_global(chosen),
        chosen,
        nearest,
        own.original_nodes[chosen],
        own.points[chosen],
        areas[chosen],
        areas[chosen, None] * n,
        n,
        faces,
        weights,
        np.sum((own.points[chosen] - reached) * n, axis=1),
        surface,
    )
