"""One conforming mesh of a geometry, and a submesh with named surfaces for each body."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import sha256
from typing import Any, TypeVar

from mpi4py import MPI

import dolfinx
import numpy as np
from dolfinx import fem, la
from numpy.typing import NDArray

from castx.arrays import BoolArray, FloatArray, IntArray, LongArray
from castx.case.geometry import Geometry
from castx.domain import compat
from castx.domain.cell_kinds import KINDS, CellKind
from castx.domain.faces import INSIDE, face_names, marked_between, neighbours
from castx.domain.gmsh_import import NamedMesh
from castx.domain.partition import destinations, partition
from castx.domain.soundness import (
    doubts,
    refuse_absurd_extent,
    refuse_far_away,
    refuse_folded,
)
from castx.domain.source import named_mesh, source_of
from castx.domain.walls import Walls, walls
from castx.errors import MeshError
from castx.input.problems import among
from castx.meshes.cad.report import Report
from castx.meshes.model import SYMMETRY
from castx.stateful import Numbering

T = TypeVar("T")
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class BodyMesh:
    """The mesh of one body.

    Args:
        name: of the body.
        mesh: its own mesh.
        facet_tags: its named outer facets.
        surfaces: tag of each surface, the same on all ranks; facets shared with another body have
            its name.
        nodes: linear scalar functions, whose dof numbers are the node numbers.
        parent_vertices: (nodes,) local vertex of the parent mesh of each local node.
        original_nodes: (nodes,) number that each local node has in the mesh before it is
            distributed, the same for any number of ranks.
        original_cells: (cells,) the same of the local cells.
        nodes_on: local nodes of each surface.
    """

    name: str
    mesh: dolfinx.mesh.Mesh
    facet_tags: dolfinx.mesh.MeshTags
    surfaces: dict[str, int]
    nodes: fem.FunctionSpace
    parent_vertices: IntArray
    original_nodes: LongArray
    original_cells: LongArray
    nodes_on: dict[str, IntArray] = field(repr=False)

    @property
    def kind(self) -> CellKind:
        """Kind of its cells."""
        return KINDS[self.mesh.topology.cell_name()]

    @property
    def symmetry_planes(self) -> list[str]:
        """Names of the surfaces on planes of symmetry, sorted."""
        return sorted(name for name in self.surfaces if name.startswith(SYMMETRY))

    @property
    def node_numbering(self) -> Numbering:
        """The local nodes by their numbers in the mesh before it was distributed."""
        owned = self.nodes.dofmap.index_map.size_local
        return Numbering(f"nodes of {self.name}", self.original_nodes, owned, (self.name,))

    @property
    def cell_numbering(self) -> Numbering:
        """The local cells by their numbers in the mesh before it was distributed."""
        owned = self.mesh.topology.index_map(self.mesh.topology.dim).size_local
        return Numbering(f"cells of {self.name}", self.original_cells, owned, (self.name,))

    @property
    def points(self) -> FloatArray:
        """Coordinates of the local nodes (nodes, gdim) [m], exactly as meshed."""
        geometry = self.mesh.geometry
        points = np.empty((len(self.parent_vertices), geometry.dim))
        corners = compat.geometry_nodes(self.mesh).ravel()
        points[self.nodes.dofmap.list.ravel()] = geometry.x[corners, : geometry.dim]
        return points

    @cached_property
    def nodal_sums(self) -> la.Vector:
        """A vector over the nodes in which sums over ranks are made; the first time collective."""
        return la.vector(self.nodes.dofmap.index_map)

    @cached_property
    def vectors(self) -> fem.FunctionSpace:
        """Linear functions with a vector at each node; the first time collective."""
        return fem.functionspace(self.mesh, ("Lagrange", 1, (self.mesh.geometry.dim,)))

    def surface_tag(self, name: str) -> int:
        """Return the tag of a surface.

        Raises:
            MeshError: the body has no such surface.
        """
        if name not in self.surfaces:
            known = among(name, sorted(self.surfaces), what="it has")
            raise MeshError(f"body {self.name!r} has no surface {name!r}; {known}")
        return self.surfaces[name]

    def surface_nodes(self, name: str) -> IntArray:
        """Return the local nodes of a surface, ghosts included, ascending.

        Raises:
            MeshError: the body has no such surface.
        """
        self.surface_tag(name)
        return self.nodes_on[name]


@dataclass(frozen=True)
class CastingMesh:
    """One conforming mesh and its bodies, in the order of the case.

    Args:
        comm: ranks.
        model: geometric model.
        parent: mesh of all bodies.
        bodies: by name.
        digest: hash (SHA-256) of points, cells and bodies before they are distributed.
        marked: points (points, gdim) of the faces between bodies that the mesh names [m].
        report: what was made of CAD files; None without them.
        walls: of the bodies, by name.
    """

    comm: MPI.Intracomm
    model: str
    parent: dolfinx.mesh.Mesh
    bodies: dict[str, BodyMesh]
    digest: str
    marked: dict[str, FloatArray] = field(default_factory=dict, repr=False)
    report: Report | None = field(default=None, repr=False)
    walls: dict[str, Walls] = field(default_factory=dict, repr=False)


def build_mesh(geometry: Geometry, body_names: Sequence[str], comm: MPI.Intracomm) -> CastingMesh:
    """Make or read the mesh on rank 0, distribute it and divide it into bodies; collective.

    Args:
        geometry: to be meshed.
        body_names: names of the bodies of the case, in their order.
        comm: ranks of the mesh.

    Raises:
        MeshError: the geometry cannot be meshed, or its names, elements or dimension do not fit the
            case; on all ranks.
    """

    def prepare() -> _Prepared:
        mesh = named_mesh(geometry, body_names)
        return _prepare(mesh, body_names, comm.size, geometry)

    prepared = _on_rank_zero(comm, prepare)
    kind, surface_names, bodies, names, digest, marked, report, thin = comm.bcast(
        (
            prepared.mesh.kind.name,
            prepared.mesh.surface_names,
            prepared.mesh.bodies,
            prepared.face_names,
            _digest(prepared.mesh),
            prepared.marked,
            prepared.mesh.report,
            prepared.walls,
        )
        if prepared
        else None
    )
    parent = _distributed(comm, KINDS[kind], prepared)
    cell = np.asarray(parent.topology.original_cell_index)
    face_of = [*surface_names, *body_names]
    return CastingMesh(
        comm,
        geometry.model,
        parent,
        {
            body: _body_mesh(parent, body, bodies[cell] == index, names[cell], face_of)
            for index, body in enumerate(body_names)
        },
        digest,
        marked,
        report,
        dict(zip(body_names, thin, strict=True)),
    )


@dataclass(frozen=True)
class _Prepared:
    """The mesh on rank 0 with the destinations of its cells."""

    mesh: NamedMesh
    face_names: NDArray[np.int16]
    parts: IntArray
    offsets: IntArray
    marked: dict[str, FloatArray]
    walls: list[Walls]


def _on_rank_zero(comm: MPI.Intracomm, task: Callable[[], T]) -> T | None:
    """Run a task on rank 0, and raise its errors as `MeshError` on all ranks."""
    result, failure, message = None, None, None
    if comm.rank == 0:
        try:
            result = task()
        except (Exception, SystemExit) as error:  # any failure has to reach the other ranks
            failure, message = error, str(error)
            if not isinstance(error, MeshError):
                message = f"making the mesh failed: {type(error).__name__}: {error}"
    message = comm.bcast(message)
    if message is not None:
        raise MeshError(message) from failure
    return result


def _prepare(
    mesh: NamedMesh, body_names: Sequence[str], parts: int, geometry: Geometry
) -> _Prepared:
    source = source_of(geometry)
    refuse_absurd_extent(mesh, source)
    refuse_far_away(mesh, source)
    across = neighbours(mesh.cells, mesh.kind.faces, source)
    refuse_folded(mesh, across, source)
    for doubt in doubts(mesh, tuple(body_names), across):
        log.warning("%s: %s", source, doubt)
    names = face_names(mesh, across, source)
    midpoints = mesh.points[mesh.cells].mean(axis=1)
    ranks = partition(midpoints, mesh.bodies, across, parts)
    return _Prepared(
        mesh,
        names.astype(np.int16),
        *destinations(ranks, across),
        marked_between(mesh, across),
        walls(mesh, across, names, body_names, geometry.model == "axisymmetric"),
    )


def _digest(mesh: NamedMesh) -> str:
    digest = sha256(mesh.kind.name.encode())
    for array in (mesh.points, mesh.cells, mesh.bodies):
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def _distributed(
    comm: MPI.Intracomm, kind: CellKind, prepared: _Prepared | None
) -> dolfinx.mesh.Mesh:
    points: FloatArray = np.empty((0, kind.dimension))
    cells: LongArray = np.empty((0, kind.corners), dtype=np.int64)
    parts: IntArray = np.empty(0, dtype=np.int32)
    offsets: IntArray = np.zeros(1, dtype=np.int32)
    if prepared is not None:
        points, cells = prepared.mesh.points, prepared.mesh.cells
        parts, offsets = prepared.parts, prepared.offsets

    def partitioner(*_: Any) -> Any:
        return compat.destinations(parts, offsets)

    return compat.create_linear_mesh(comm, points, cells, kind.name, partitioner)


def _body_mesh(
    parent: dolfinx.mesh.Mesh,
    name: str,
    inside: BoolArray,
    names: NDArray[np.int16],
    face_of: Sequence[str],
) -> BodyMesh:
    """Return the mesh of a body.

    Args:
        parent: the mesh of all bodies.
        name: of the body.
        inside: (local cells,) cells of the body.
        names: (local cells, faces) name of each face, an index into face_of.
        face_of: names of surfaces and bodies.
    """
    mesh, cells, vertices = compat.create_submesh(parent, np.flatnonzero(inside).astype(np.int32))
    dim = mesh.topology.dim
    for pair in ((dim, dim - 1), (dim - 1, dim), (dim, 0), (dim - 1, 0)):
        mesh.topology.create_connectivity(*pair)
    facets, values = _named_facets(mesh, names[cells])
    present = np.zeros(len(face_of), dtype=bool)
    present[values] = True
    parent.comm.Allreduce(MPI.IN_PLACE, present, MPI.LOR)
    surfaces = {face_of[index]: int(index) + 1 for index in np.flatnonzero(present)}
    space = fem.functionspace(mesh, ("Lagrange", 1))
    vertex_nodes = _vertex_nodes(space)
    parent_vertices = np.empty(len(vertex_nodes), dtype=np.int32)
    parent_vertices[vertex_nodes] = vertices
    original_cells = np.asarray(parent.topology.original_cell_index, dtype=np.int64)[cells]
    tags = dolfinx.mesh.meshtags(mesh, dim - 1, facets, values + 1)
    nodes_on = {s: _nodes_on(space, vertex_nodes, tags.find(tag)) for s, tag in surfaces.items()}
    return BodyMesh(
        name, mesh, tags, surfaces, space, parent_vertices,
        _original_vertices(parent)[parent_vertices], original_cells, nodes_on,
    )  # fmt: skip


def _original_vertices(mesh: dolfinx.mesh.Mesh) -> LongArray:
    """Return the number of each local vertex in the mesh before it was distributed."""
    topology, geometry = mesh.topology, mesh.geometry
    index_map = topology.index_map(0)
    numbers = np.empty(index_map.size_local + index_map.num_ghosts, dtype=np.int64)
    corners = topology.connectivity(topology.dim, 0).array
    numbers[corners] = geometry.input_global_indices[compat.geometry_nodes(mesh).ravel()]
    return numbers


def _named_facets(mesh: dolfinx.mesh.Mesh, names: NDArray[np.int16]) -> tuple[IntArray, IntArray]:
    """Return the local facets that have a name, ascending, and the indices of their names."""
    dim = mesh.topology.dim
    facets = mesh.topology.connectivity(dim, dim - 1).array.reshape(names.shape)
    facets, first = np.unique(facets[names != INSIDE], return_index=True)
    return facets.astype(np.int32), names[names != INSIDE][first].astype(np.int32)


def _vertex_nodes(space: fem.FunctionSpace) -> IntArray:
    """Return the local node of each local vertex."""
    topology = space.mesh.topology
    nodes = np.empty(
        space.dofmap.index_map.size_local + space.dofmap.index_map.num_ghosts, dtype=np.int32
    )
    nodes[topology.connectivity(topology.dim, 0).array] = space.dofmap.list.ravel()
    return nodes


def _nodes_on(space: fem.FunctionSpace, vertex_nodes: IntArray, facets: IntArray) -> IntArray:
    """Return the local nodes of facets of all ranks; collective."""
    topology = space.mesh.topology
    kind = KINDS[topology.cell_name()]
    corners = topology.connectivity(topology.dim - 1, 0).array.reshape(-1, kind.faces.shape[1])
    marker = la.vector(space.dofmap.index_map, 1, dtype=np.int8)
    marker.array[:] = 0
    marker.array[vertex_nodes[corners[facets].ravel()]] = 1
    marker.scatter_reverse(la.InsertMode.add)
    marker.scatter_forward()
    return np.flatnonzero(marker.array).astype(np.int32)
