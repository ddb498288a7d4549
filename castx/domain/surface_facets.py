"""The facets of a surface of a body, gathered on all ranks.

Areas and area vectors are kept facet by facet, since a patch of an interface adds up those of some
facets only; `castx.domain.measures` has the sums over all facets round each node.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.domain.cell_kinds import KINDS, CellKind
from castx.domain.mesh import BodyMesh, CastingMesh

DEGREE = 3
"""Of the quadrature: exact for a corner's share of a flat facet, whose weight is linear."""


@dataclass(frozen=True)
class SurfaceFacets:
    """Facets of all ranks, in an order that depends on the number of ranks.

    Attributes:
        kind: of the facets.
        nodes: global node numbers of the body, shape (facets, corners).
        points: of the corners [m], shape (facets, corners, dimension).
        normals: outward unit vectors in the middle of the facets, shape (facets, dimension).
        areas: ∫φ dS of the corners [m²], shape (facets, corners).
        vectors: ∫φ n dS of the corners, n outward [m²], shape (facets, corners, dimension).
    """

    kind: CellKind
    nodes: LongArray
    points: FloatArray
    normals: FloatArray
    areas: FloatArray
    vectors: FloatArray


def surface_facets(mesh: CastingMesh, body: BodyMesh, surface: str) -> SurfaceFacets:
    """Return the facets of a named surface of all ranks; collective.

    Raises:
        MeshError: the body has no such surface.
    """
    corners, inside = _owned_facets(body, surface)
    points = body.points[corners]
    face = KINDS[body.kind.face]
    vectors, areas = _integrals(face, points, mesh.model)
    normals = _unit_normal(face, points)
    away = np.sum(normals * (points.mean(axis=1) - inside), axis=1) > 0
    sign = np.where(away, 1.0, -1.0)
    nodes = body.nodes.dofmap.index_map.local_to_global(corners.ravel().astype(np.int32))
    parts = (
        nodes.reshape(corners.shape),
        points,
        sign[:, None] * normals,
        areas,
        sign[:, None, None] * vectors,
    )
    gathered = zip(*mesh.comm.allgather(parts), strict=True)
    return SurfaceFacets(face, *(np.concatenate(part) for part in gathered))


def _owned_facets(body: BodyMesh, surface: str) -> tuple[LongArray, FloatArray]:
    """Return the local nodes of the facets of owned cells, and the centres of these cells."""
    topology, kind = body.mesh.topology, body.kind
    dimension = topology.dim
    facets = body.facet_tags.find(body.surface_tag(surface))
    cells_of = topology.connectivity(dimension - 1, dimension)
    cells = np.array([cells_of.links(facet)[0] for facet in facets], dtype=np.int64)
    facets_of = topology.connectivity(dimension, dimension - 1).array
    facets_of = facets_of.reshape(-1, len(kind.faces))
    owned = cells < topology.index_map(dimension).size_local
    cells, facets = cells[owned], facets[owned]
    place = np.argmax(facets_of[cells] == facets[:, None], axis=1)
    nodes = body.nodes.dofmap.list[cells]
    middle = body.points[nodes].mean(axis=1)
    return np.take_along_axis(nodes, kind.faces[place], axis=1).astype(np.int64), middle


def _integrals(face: CellKind, points: FloatArray, model: str) -> tuple[FloatArray, FloatArray]:
    """Return ∫φ n dS and ∫φ dS of the corners of facets, weighted by the model."""
    places, weights = face.quadrature(DEGREE)
    shapes = face.shape_functions(places)[0]
    normal = _normal(face, points, places)
    weight = np.broadcast_to(weights, normal.shape[:2]).copy()
    if model == "axisymmetric":
        weight *= 2 * np.pi * np.einsum("qa,fa->fq", shapes, points[:, :, 0])
    vectors = np.einsum("fq,qa,fqk->fak", weight, shapes, normal)
    areas = np.einsum("fq,qa,fq->fa", weight, shapes, np.linalg.norm(normal, axis=2))
    return vectors, areas


def _unit_normal(face: CellKind, points: FloatArray) -> FloatArray:
    middle = face.reference.mean(axis=0, keepdims=True)
    normal = _normal(face, points, middle)[:, 0]
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))


def _normal(face: CellKind, points: FloatArray, places: FloatArray) -> FloatArray:
    """Return normals whose length is the area of ∂x/∂ξ, (facets, places, dimension)."""
    # From the first corner: gradients of shape functions add up to zero but for rounding, by which
    # the normal of a facet along an axis would lean.
    jacobians = face.jacobians(points - points[:, :1], places)
    if jacobians.shape[2] == 2:
        tangent = jacobians[:, :, :, 0]
        return np.stack((tangent[:, :, 1], -tangent[:, :, 0]), axis=2)
    return np.asarray(np.cross(jacobians[:, :, :, 0], jacobians[:, :, :, 1]), dtype=np.float64)
