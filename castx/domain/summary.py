"""Sizes of a mesh, shown by `castx check` before anything is solved."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from math import inf, pi

from mpi4py import MPI

import numpy as np
from dolfinx.mesh import entities_to_geometry

from castx.arrays import FloatArray, IntArray
from castx.domain.cell_kinds import KINDS
from castx.domain.mesh import BodyMesh, CastingMesh
from castx.meshes.model import SYMMETRY

QUADRATURE_DEGREE = 4
"""Exact for cells and plane faces, times the radius; other faces have areas that no polynomial is.
"""


@dataclass(frozen=True)
class BodySummary:
    """Sizes of one body, of the full turn when axisymmetric, per metre of depth in plane models.

    Args:
        name: of the body.
        cells: number of elements.
        nodes: number of nodes.
        volume: of the body [m³].
        surfaces: area of each named surface and of each face shared with another body [m²].
        unnamed: area of outer faces without a name, which no boundary condition can reach [m²].
        heights: mean height of the cells over their faces shared with another body, by its name
            [m].
    """

    name: str
    cells: int
    nodes: int
    volume: float
    surfaces: dict[str, float]
    unnamed: float
    heights: dict[str, float]

    @property
    def modulus(self) -> float:
        """Volume over surface, without planes of symmetry [m]; infinite without a surface."""
        areas = (a for name, a in self.surfaces.items() if not name.startswith(SYMMETRY))
        area = sum(areas) + self.unnamed
        return self.volume / area if area > 0.0 else inf


@dataclass(frozen=True)
class InterfaceSummary:
    """Sizes of the surface that two bodies share.

    Args:
        bodies: their names.
        nodes: on it.
        area: of the surface [m²].
    """

    bodies: tuple[str, str]
    nodes: int
    area: float


@dataclass(frozen=True)
class MeshSummary:
    """Sizes of a mesh.

    Args:
        lowest: smallest coordinates of all bodies (gdim,) [m].
        highest: largest coordinates [m].
        bodies: in the order of the case.
        interfaces: all surfaces that two bodies share.
    """

    lowest: tuple[float, ...]
    highest: tuple[float, ...]
    bodies: tuple[BodySummary, ...]
    interfaces: tuple[InterfaceSummary, ...]

    @property
    def moduli(self) -> dict[str, float]:
        """Volume over surface of the bodies by their names [m]."""
        return {body.name: body.modulus for body in self.bodies}

    def height(self, body: str, other: str) -> float | None:
        """Return the height of the cells of a body at another one [m], None where they are apart.

        Args:
            body: its name.
            other: name of the one that it touches.
        """
        heights = {each.name: each.heights for each in self.bodies}
        return heights[body].get(other)


def mesh_summary(mesh: CastingMesh) -> MeshSummary:
    """Return the sizes of a mesh; collective, the same on all ranks."""
    gdim = mesh.parent.geometry.dim
    points = mesh.parent.geometry.x[:, :gdim]
    lowest, highest = np.full(gdim, np.inf), np.full(gdim, -np.inf)
    if len(points):
        lowest, highest = points.min(axis=0), points.max(axis=0)
    mesh.comm.Allreduce(MPI.IN_PLACE, lowest, MPI.MIN)
    mesh.comm.Allreduce(MPI.IN_PLACE, highest, MPI.MAX)
    bodies = {name: _body_summary(mesh, body) for name, body in mesh.bodies.items()}
    return MeshSummary(
        tuple(map(float, lowest)),
        tuple(map(float, highest)),
        tuple(bodies.values()),
        tuple(
            InterfaceSummary((a, b), _count_nodes(mesh, a, b), bodies[a].surfaces[b])
            for a, b in combinations(mesh.bodies, 2)
            if b in mesh.bodies[a].surfaces
        ),
    )


def _body_summary(mesh: CastingMesh, body: BodyMesh) -> BodySummary:
    topology = body.mesh.topology
    cells = topology.index_map(topology.dim)
    owned = np.arange(cells.size_local, dtype=np.int32)
    outer = _owned_outer_facets(body)
    tags = np.zeros(topology.index_map(topology.dim - 1).size_local, dtype=np.int32)
    tagged = body.facet_tags.indices < len(tags)
    tags[body.facet_tags.indices[tagged]] = body.facet_tags.values[tagged]
    measures = _measures(mesh, body, topology.dim - 1, outer)
    surfaces = {s: measures[tags[outer] == tag].sum() for s, tag in body.surfaces.items()}
    volume = _measures(mesh, body, topology.dim, owned).sum()
    return BodySummary(
        body.name,
        cells.size_global,
        body.nodes.dofmap.index_map.size_global,
        float(mesh.comm.allreduce(volume)),
        {name: float(mesh.comm.allreduce(area)) for name, area in surfaces.items()},
        float(mesh.comm.allreduce(measures[tags[outer] == 0].sum())),
        {
            other: _height(mesh, body, outer[tags[outer] == body.surfaces[other]])
            for other in mesh.bodies
            if other in body.surfaces
        },
    )


def _height(mesh: CastingMesh, body: BodyMesh, facets: IntArray) -> float:
    """Return the mean height of the cells over facets, weighted by their areas; collective [m]."""
    topology = body.mesh.topology
    cells = topology.connectivity(topology.dim - 1, topology.dim)
    behind = cells.array[cells.offsets[facets]].astype(np.int32)
    shape = topology.dim if body.kind.simplex else 1
    volume = shape * _measures(mesh, body, topology.dim, behind, full_turn=False).sum()
    area = _measures(mesh, body, topology.dim - 1, facets, full_turn=False).sum()
    volume, area = mesh.comm.allreduce(volume), mesh.comm.allreduce(area)
    return float(volume / area) if area > 0.0 else 0.0


def _owned_outer_facets(body: BodyMesh) -> IntArray:
    topology = body.mesh.topology
    cells = topology.connectivity(topology.dim - 1, topology.dim)
    owned = topology.index_map(topology.dim - 1).size_local
    return np.flatnonzero(np.diff(cells.offsets)[:owned] == 1).astype(np.int32)


def _measures(
    mesh: CastingMesh, body: BodyMesh, dim: int, entities: IntArray, full_turn: bool = True
) -> FloatArray:
    """Return length, area or volume of cells or facets, times 2πr when axisymmetric.

    Args:
        mesh: all bodies.
        body: that has them.
        dim: their dimension.
        entities: their numbers.
        full_turn: whether axisymmetric ones are turned about the axis.
    """
    if not len(entities):  # DOLFINx divides by the number of cells
        return np.empty(0)
    kind = body.kind if dim == body.kind.dimension else KINDS[body.kind.face]
    nodes = entities_to_geometry(body.mesh, dim, entities)
    corners: FloatArray = np.asarray(body.mesh.geometry.x, dtype=np.float64)[nodes]
    points, weights = kind.quadrature(QUADRATURE_DEGREE)
    jacobians = kind.jacobians(corners, points)
    gram = np.einsum("cpik,cpil->cpkl", jacobians, jacobians)
    densities = np.sqrt(np.maximum(np.linalg.det(gram), 0.0))
    if mesh.model == "axisymmetric" and full_turn:
        densities *= 2 * pi * corners[:, :, 0] @ kind.shape_functions(points)[0].T
    return np.asarray(densities @ weights)


def _count_nodes(mesh: CastingMesh, secondary: str, primary: str) -> int:
    body = mesh.bodies[secondary]
    owned = body.nodes.dofmap.index_map.size_local
    return int(mesh.comm.allreduce(np.count_nonzero(body.surface_nodes(primary) < owned)))
