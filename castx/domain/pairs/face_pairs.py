"""Nodes of one body that face the facets of another, for surfaces whose meshes do not match.

Each node is projected once onto the closest point of the other surface: displacements are small.
The force of a node acts on the corners of its facet by the shape functions there. These forces are
those of a uniform pressure only if every facet is divided evenly: elsewhere forces balance, but the
patch test fails (Taylor and Papadopoulos 1991), and single pressures too, however fine the mesh.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray, IntArray
from castx.case.contact import Pairing
from castx.domain.measures import nodal_area_vectors, nodal_areas
from castx.domain.mesh import BodyMesh, CastingMesh
from castx.domain.pairs.closest_point import ClosestPoints
from castx.domain.pairs.facing import SurfacePoints, faced, facet_sizes
from castx.domain.pairs.node_pairs import NodePairs
from castx.domain.surface_facets import SurfaceFacets, surface_facets
from castx.errors import MeshError


@dataclass(frozen=True)
class FaceInterface:
    """An interface from node to face, and the facets of both sides.

    Attributes:
        bodies: names of the secondary and the primary body.
        surfaces: their names on these bodies.
        rule: normals, search distance, and whether the distance of the meshes counts.
        facets: of both surfaces.
    """

    bodies: tuple[str, str]
    surfaces: tuple[str, str]
    rule: Pairing
    facets: tuple[SurfaceFacets, SurfaceFacets]


@dataclass(frozen=True)
class FacingNodes:
    """The owned nodes of a surface that face another one.

    Attributes:
        interface: the two surfaces.
        own: mesh of the secondary body.
        local: numbers of the nodes, shape (n,).
        found: the closest point of the other surface to each of them.
        areas: of the nodes on the whole surface [m²], shape (n,).
        outward: unit normals of their own surface, shape (n, dimension).
    """

    interface: FaceInterface
    own: BodyMesh
    local: IntArray
    found: ClosestPoints
    areas: FloatArray
    outward: FloatArray

    def pairs(self, areas: FloatArray, outward: FloatArray) -> NodePairs:
        """Return the pairs of the nodes that have an area.

        Args:
            areas: of the nodes [m²], shape (n,).
            outward: unit normals of their own surface, shape (n, dimension).
        """
        kept, rule, found = areas > 0, self.interface.rule, self.found
        facets, local = self.interface.facets[1], self.local[kept]
        of_primary = rule.normals == "primary"
        n = (found.normals if of_primary else _unit(found.normals - outward))[kept]
        facet, weights = found.facet[kept], found.weights[kept]
        faces = facets.nodes[facet]
        reached = np.einsum("na,nak->nk", weights, facets.points[facet])
        nearest = np.take_along_axis(faces, np.argmax(weights, axis=1)[:, None], axis=1)[:, 0]
        points = self.own.points[local]
        return NodePairs(
            *self.interface.bodies,
            self.own.nodes.dofmap.index_map.local_to_global(local),
            local,
            nearest,
            self.own.original_nodes[local],
            points,
            areas[kept],
            areas[kept, None] * n,
            n,
            faces,
            weights,
            np.sum((points - reached) * n, axis=1) if rule.meshed_gap else None,
            self.interface.surfaces[0],
        )


def face_interface(
    mesh: CastingMesh, secondary: str, primary: str, rule: Pairing
) -> FaceInterface:
    """Return the two surfaces of an interface from node to face; collective.

    Args:
        mesh: mesh of the bodies.
        secondary: name of the body whose nodes carry the pairs.
        primary: name of the other body.
        rule: names of surfaces, normals, search distance, and whether the distance of the meshes
            counts.

    Raises:
        MeshError: a surface is missing; on all ranks.
    """
    surfaces = rule.surfaces or (primary, secondary)
    if rule.surfaces is None and primary not in mesh.bodies[secondary].surfaces:
        raise MeshError(
            f"the bodies {secondary!r} and {primary!r} share no surface: name those that face each "
            'other, contact = { pairing = "node-to-face", surfaces = ["of the first", "of the '
            'second"] }'
        )
    facets = []
    for body, surface in zip((secondary, primary), surfaces, strict=True):
        facets.append(surface_facets(mesh, mesh.bodies[body], surface))
        if len(facets[-1].nodes) == 0:
            raise MeshError(f"surface {surface!r} of body {body!r} has no facets")
    return FaceInterface((secondary, primary), surfaces, rule, (facets[0], facets[1]))


def facing_nodes(mesh: CastingMesh, interface: FaceInterface) -> FacingNodes:
    """Return the nodes of the secondary surface that face the primary one; collective.

    Raises:
        MeshError: none does; on all ranks.
    """
    own, name = mesh.bodies[interface.bodies[0]], interface.surfaces[0]
    local = own.surface_nodes(name)
    local = local[local < own.nodes.dofmap.index_map.size_local]
    outward = _unit(nodal_area_vectors(own, mesh.model, name)[local])
    points = SurfacePoints(own.points[local], outward, _node_sizes(own, interface.facets[0])[local])
    found, distance = faced(points, interface.facets[1], interface.rule.search_distance)
    kept = np.isfinite(distance)
    if mesh.comm.allreduce(int(np.count_nonzero(kept))) == 0:
        raise _nothing_faced(interface)
    areas = nodal_areas(own, mesh.model, name)
    found = ClosestPoints(found.facet[kept], found.weights[kept], found.normals[kept])
    return FacingNodes(interface, own, local[kept], found, areas[local[kept]], outward[kept])


def _nothing_faced(interface: FaceInterface) -> MeshError:
    (secondary, primary), (name, facing) = interface.bodies, interface.surfaces
    given = interface.rule.search_distance
    reach = "the size of the mesh" if given is None else f"{given:g} m"
    return MeshError(
        f"no node of {secondary}/{name} faces {primary}/{facing}; both surfaces must lie "
        f"opposite each other, no farther apart than contact.search_distance ({reach})"
    )


def _node_sizes(body: BodyMesh, facets: SurfaceFacets) -> FloatArray:
    """Return the longest edge of the facets round each owned node [m], shape (owned,)."""
    low, high = body.nodes.dofmap.index_map.local_range
    nodes = facets.nodes.ravel()
    mine = (nodes >= low) & (nodes < high)
    sizes = np.zeros(high - low)
    per_corner = np.repeat(facet_sizes(facets), facets.nodes.shape[1])
    np.maximum.at(sizes, nodes[mine] - low, per_corner[mine])
    return sizes


def _unit(vectors: FloatArray) -> FloatArray:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.where(lengths > 0, lengths, 1.0))
