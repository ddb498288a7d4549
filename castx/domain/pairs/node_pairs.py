"""Facing nodes of two bodies that share a surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from dolfinx import la

from castx.arrays import BoolArray, FloatArray, IntArray, LongArray
from castx.domain.measures import nodal_area_vectors, nodal_areas
from castx.domain.mesh import BodyMesh, CastingMesh
from castx.errors import MeshError
from castx.stateful import Numbering, numbered_at_nodes


@dataclass(frozen=True)
class NodePairs:
    """Pairs of nodes, each on the rank that owns its secondary node.

    At an edge there may be several pairs of the same nodes, one for each smooth patch.

    Args:
        secondary: name of the body whose nodes carry the pairs.
        primary: name of the other body, whose outward normal is that of the pairs.
        secondary_nodes: (n,) global node numbers of the secondary body.
        secondary_local: (n,) their local numbers.
        primary_nodes: (n,) global node numbers of the primary body, of any owner.
        original_nodes: (n,) numbers of the secondary nodes before the mesh was distributed.
        points: (n, gdim) [m].
        areas: (n,) ∫φ dS; of the full turn when axisymmetric, per metre of depth in plane models
            [m²].
        area_vectors: (n, gdim) ∫φ n dS, n the outward normal of the primary [m²].
        normals: (n, gdim) unit vectors along the area vectors.
        faces: (n, corners) global numbers of the primary nodes of the facet that each node faces;
            None: it faces its primary node.
        weights: (n, corners) of those nodes at the point that it faces.
        distances: (n,) from that point along the normal [m]; None: both are at one place.
        named_surface: of the secondary body; empty: the one shared with the primary body.
        primary_area: of that part of the primary surface which faces the secondary one, of all
            ranks [m²]; None: both are one surface.
        given_gap: (n,) gap that counts beside the meshed one [m], negative: interference.
    """

    secondary: str
    primary: str
    secondary_nodes: LongArray
    secondary_local: IntArray
    primary_nodes: LongArray
    original_nodes: LongArray
    points: FloatArray
    areas: FloatArray
    area_vectors: FloatArray
    normals: FloatArray
    faces: LongArray | None = None
    weights: FloatArray | None = None
    distances: FloatArray | None = None
    named_surface: str = ""
    primary_area: float | None = None
    given_gap: FloatArray | float = 0.0

    @property
    def partners(self) -> tuple[LongArray, FloatArray]:
        """The primary nodes that each secondary node faces and their weights, (n, corners)."""
        if self.faces is None or self.weights is None:
            return self.primary_nodes[:, None], np.ones((len(self.areas), 1))
        return self.faces, self.weights

    @property
    def surface(self) -> str:
        """Name of the surface of the secondary body that carries the pairs."""
        return self.named_surface or self.primary

    @property
    def meshed_gap(self) -> FloatArray:
        """Distance of the surfaces as they are meshed [m], shape (n,)."""
        return np.zeros(len(self.areas)) if self.distances is None else self.distances

    @property
    def gap(self) -> FloatArray:
        """Gap without displacement, meshed and given [m], shape (n,)."""
        return np.asarray(self.meshed_gap + self.given_gap)

    @property
    def name(self) -> str:
        """The name of the interface: "secondary/primary"."""
        return f"{self.secondary}/{self.primary}"

    @property
    def numbering(self) -> Numbering:
        """The pairs by the numbers of their secondary nodes and their order at each node."""
        return numbered_at_nodes(
            f"pairs of {self.name}", self.original_nodes, (self.secondary, self.primary)
        )


def node_pairs(mesh: CastingMesh, secondary: str, primary: str) -> NodePairs:
    """Return pairs of the nodes that two bodies share; collective.

    Args:
        mesh: mesh of the bodies.
        secondary: name of the body whose nodes carry the pairs.
        primary: name of the other body.

    Raises:
        MeshError: the bodies share no surface, or its normals cancel at a node; on all ranks.
    """
    body = mesh.bodies[secondary]
    check_shared(body, primary)
    local = body.surface_nodes(primary)
    local = local[local < body.nodes.dofmap.index_map.size_local]
    areas = nodal_areas(body, mesh.model, primary)
    vectors = nodal_area_vectors(body, mesh.model, primary)
    return pairs_at(mesh, secondary, primary, local, areas[local], vectors[local])


def check_shared(body: BodyMesh, other: str) -> None:
    """Refuse a body that shares no surface with another one.

    Raises:
        MeshError: it does not.
    """
    if other not in body.surfaces:
        raise MeshError(
            f"the bodies {body.name!r} and {other!r} share no surface; an interface needs faces "
            "whose nodes belong to both (a conforming mesh)"
        )


def pairs_at(
    mesh: CastingMesh,
    secondary: str,
    primary: str,
    local: IntArray,
    areas: FloatArray,
    vectors: FloatArray,
) -> NodePairs:
    """Return pairs at nodes of a shared surface; collective.

    Args:
        mesh: mesh of the bodies.
        secondary: name of the body whose nodes carry the pairs.
        primary: name of the other body.
        local: local numbers of owned nodes of the secondary body, shape (n,).
        areas: of the pairs [m²], shape (n,).
        vectors: their area vectors, outward from the secondary body [m²], shape (n, gdim).

    Raises:
        MeshError: an area vector vanishes; on all ranks.
    """
    body = mesh.bodies[secondary]
    facing = _nodes_at_vertices(mesh, mesh.bodies[primary])
    length = np.linalg.norm(vectors, axis=1)
    _check_normals(mesh, body, local, length < 1e-9 * areas)
    return NodePairs(
        secondary,
        primary,
        body.nodes.dofmap.index_map.local_to_global(local),
        local,
        facing[body.parent_vertices[local]],
        body.original_nodes[local],
        body.points[local],
        areas,
        -vectors,
        -vectors / length[:, None],
    )


def _nodes_at_vertices(mesh: CastingMesh, body: BodyMesh) -> LongArray:
    """Return the global node of a body at each local vertex of the parent, else -1; collective.

    Owners of nodes and of vertices differ: the owner of a node sends its number to every rank that
    has the vertex.
    """
    node_map = body.nodes.dofmap.index_map
    owned = np.arange(node_map.size_local, dtype=np.int32)
    number = la.vector(mesh.parent.topology.index_map(0), 1, dtype=np.int64)
    number.array[:] = 0
    number.array[body.parent_vertices[owned]] = node_map.local_to_global(owned) + 1
    number.scatter_reverse(la.InsertMode.add)
    number.scatter_forward()
    return number.array - 1


def _check_normals(
    mesh: CastingMesh, body: BodyMesh, local: IntArray, bad: BoolArray
) -> None:
    points = mesh.comm.allgather(body.points[local[bad]])
    found = np.concatenate(points)
    if len(found):
        place = ", ".join(f"{x:g}" for x in found[0])
        raise MeshError(
            f"body {body.name!r} is so thin at ({place}) m that the normals of its two sides "
            "cancel there; refine the mesh"
        )
