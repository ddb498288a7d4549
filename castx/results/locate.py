"""Location of points in bodies and on surfaces, with the weights of interpolation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mpi4py import MPI

import numpy as np
from dolfinx import geometry
from dolfinx.mesh import entities_to_geometry

from castx.arrays import FloatArray, IntArray
from castx.domain.cell_kinds import KINDS, CellKind
from castx.domain.pairs.closest_point import project
from castx.domain.surface_facets import surface_facets

if TYPE_CHECKING:
    from dolfinx.mesh import Mesh

    from castx.domain.mesh import BodyMesh, CastingMesh


FAR = 1e3
"""Distance from the origin, in that of the farthest node, beyond which a point is only far away:
the search of DOLFINx would lose all digits of the mesh beside it."""
MOST_ITERATIONS = 30
SMALLEST_CHANGE = 1e-13
"""Of the position in the reference cell."""


@dataclass(frozen=True)
class Place:
    """The nearest point of a body or surface to a wanted point.

    Args:
        distance: from the wanted point to it [m]; equal on all ranks.
        foot: the nearest point, (gdim,) [m]; equal on all ranks.
        size: diameter of the cell or facet it lies in [m]; equal on all ranks.
        owned: whether its cell or facet is owned by this rank; true on exactly one rank.
        entity: local cell or facet, -1 on the other ranks.
        nodes: local nodes of the entity, empty on the other ranks.
        weights: of the linear, bilinear or trilinear interpolation between them.
    """

    distance: float
    foot: FloatArray
    size: float
    owned: bool
    entity: int
    nodes: IntArray
    weights: FloatArray

    def interpolate(self, values: FloatArray) -> FloatArray:
        """Return the value of a nodal field (nodes,) or (nodes, n) here, 0 on the other ranks."""
        return np.asarray(np.tensordot(self.weights, values[self.nodes], axes=1))


def place_in_body(body: BodyMesh, point: Sequence[float]) -> Place:
    """Return the nearest place of a body to a point; collective."""
    mesh = body.nodes.mesh
    dim = mesh.topology.dim
    cells = np.arange(mesh.topology.index_map(dim).size_local, dtype=np.int32)
    return nearest_place(body, dim, cells, point)


def place_on_surface(body: BodyMesh, surface: str, point: Sequence[float]) -> Place:
    """Return the nearest place of a named surface of a body to a point; collective.

    Raises:
        MeshError: the body has no such surface.
    """
    mesh = body.nodes.mesh
    dim = mesh.topology.dim - 1
    facets = body.facet_tags.find(body.surface_tag(surface))
    facets = facets[facets < mesh.topology.index_map(dim).size_local]
    return nearest_place(body, dim, facets, point)


def place_below(
    mesh: CastingMesh, body: BodyMesh, surface: str, point: Sequence[float], depth: float
) -> Place:
    """Return the place of a body at a depth under the point of its surface nearest to a point.

    Collective. The way down is normal to the surface, at an edge along the mean of the normals.

    Args:
        mesh: of all bodies.
        body: that has the surface.
        surface: its name.
        point: (gdim,) [m].
        depth: [m].

    Raises:
        MeshError: the body has no such surface.
    """
    facets = surface_facets(mesh, body, surface)
    found = project(np.array([point], dtype=np.float64), facets.points, facets.normals)
    foot = found.weights[0] @ facets.points[found.facet[0]]
    return place_in_body(body, foot - depth * found.normals[0])


def nearest_place(body: BodyMesh, dim: int, entities: IntArray, point: Sequence[float]) -> Place:
    """Return the nearest place to a point in entities of one dimension that this rank owns.

    Of places equally near, the one on the lowest rank is taken.
    """
    mesh = body.nodes.mesh
    comm = mesh.comm
    wanted = np.zeros((1, 3))
    wanted[0, : len(point)] = point
    beyond = FAR * comm.allreduce(float(np.abs(mesh.geometry.x).max(initial=0.0)), MPI.MAX)
    entity, foot = nearest_point(mesh, dim, entities, np.clip(wanted, -beyond, beyond))
    with np.errstate(over="ignore"):
        distance = np.inf if entity.size == 0 else float(np.linalg.norm(foot - wanted))
    least = comm.allreduce(distance, MPI.MIN)
    tied = comm.rank if distance <= least * (1.0 + 1e-9) + 1e-14 else comm.size
    owned = comm.rank == comm.allreduce(tied, MPI.MIN)
    size = comm.allreduce(float(mesh.h(dim, entity)[0]) if owned else 0.0, MPI.MAX)
    there = comm.allreduce(foot[0, : len(point)] if owned else np.zeros(len(point)))
    if not owned:
        return Place(least, there, size, False, -1, np.empty(0, dtype=np.int32), np.empty(0))
    kind, nodes = nodes_of(body, dim, int(entity[0]))
    corners = body.nodes.tabulate_dof_coordinates()[nodes]
    weights = interpolation_weights(kind, corners, foot[0])
    return Place(least, there, size, True, int(entity[0]), nodes, weights)


def nodes_of(body: BodyMesh, dim: int, entity: int) -> tuple[CellKind, IntArray]:
    """Return the kind of a cell or facet and its local nodes in the order of the reference one."""
    topology = body.nodes.mesh.topology
    if dim == topology.dim:
        return body.kind, body.nodes.dofmap.cell_dofs(entity)
    cell = topology.connectivity(dim, topology.dim).links(entity)[0]
    number = np.flatnonzero(topology.connectivity(topology.dim, dim).links(cell) == entity)[0]
    return KINDS[body.kind.face], body.nodes.dofmap.cell_dofs(cell)[body.kind.faces[number]]


def nearest_point(
    mesh: Mesh, dim: int, entities: IntArray, wanted: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Return the entity nearest to a point (1, 3), as an array, and its point nearest to that."""
    if entities.size == 0:
        return entities, wanted
    mesh.topology.create_connectivity(dim, mesh.topology.dim)
    tree = geometry.bb_tree(mesh, dim, entities=entities)
    middles = geometry.create_midpoint_tree(mesh, dim, entities)
    entity = geometry.compute_closest_entity(tree, middles, mesh, wanted)
    corners = mesh.geometry.x[entities_to_geometry(mesh, dim, entity)[0]]
    return entity, wanted + geometry.compute_distance_gjk(corners, wanted)


def interpolation_weights(kind: CellKind, corners: FloatArray, point: FloatArray) -> FloatArray:
    """Return the weights (corners,) of a point in a linear cell or facet, which sum to one.

    Newton's method on the position in the reference cell, in least squares where that is of lower
    dimension; one iteration for simplices.

    Args:
        kind: of the cell or facet.
        corners: positions (corners, 3) [m].
        point: (3,), in the convex hull of the corners [m].
    """
    place = kind.reference.mean(axis=0, keepdims=True)
    for _ in range(MOST_ITERATIONS):
        values, slopes = kind.shape_functions(place)
        change = np.linalg.lstsq(corners.T @ slopes[0], point - values[0] @ corners, rcond=None)[0]
        place = place + change
        if np.abs(change).max() < SMALLEST_CHANGE:
            break
    weights: FloatArray = kind.shape_functions(place)[0][0]
    return weights
