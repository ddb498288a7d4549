"""All differences between DOLFINx versions (written for 0.9 to 0.11)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpi4py import MPI

import basix.ufl
import dolfinx
import numpy as np
import ufl
from dolfinx.graph import adjacencylist
from dolfinx.mesh import Mesh

from castx.arrays import FloatArray, IntArray, LongArray

Partitioner = Callable[..., Any]


def create_linear_mesh(
    comm: MPI.Intracomm,
    points: FloatArray,
    cells: LongArray,
    kind: str,
    partitioner: Partitioner,
) -> Mesh:
    """Distribute linear cells of one kind, of which each rank gives any share; collective.

    Args:
        comm: ranks of the mesh.
        points: (points, gdim) [m], gdim also the dimension of the cells.
        cells: (cells, corners) global numbers of points.
        kind: "triangle", "quadrilateral", "tetrahedron" or "hexahedron".
        partitioner: (comm, parts, cell types, cells) -> destinations of this rank's cells.
    """
    domain = ufl.Mesh(basix.ufl.element("Lagrange", kind, 1, shape=(points.shape[1],)))
    return dolfinx.mesh.create_mesh(comm, cells=cells, x=points, e=domain, partitioner=partitioner)


def destinations(parts: IntArray, offsets: IntArray) -> Any:
    """Return lists of ranks for each cell in the form of DOLFINx's partitioners.

    Args:
        parts: ranks of all cells one after the other, the owner of a cell first.
        offsets: start of each cell in `parts`, and the end of the last one, shape (cells + 1,).
    """
    lists = adjacencylist(parts, offsets)
    return getattr(lists, "_cpp_object", lists)


def create_submesh(mesh: Mesh, cells: IntArray) -> tuple[Mesh, IntArray, IntArray]:
    """Return a mesh of some cells, and the cells and vertices of the parent mesh; collective.

    Args:
        mesh: the parent mesh.
        cells: local numbers of its cells.

    Returns:
        The mesh, and for each local cell and vertex of it that of the parent.
    """
    dim = mesh.topology.dim
    submesh, cell_map, vertex_map, _ = dolfinx.mesh.create_submesh(mesh, dim, cells)
    return submesh, _parents(submesh, dim, cell_map), _parents(submesh, 0, vertex_map)


def _parents(submesh: Mesh, dim: int, entity_map: Any) -> IntArray:
    if isinstance(entity_map, np.ndarray):
        return entity_map
    index_map = submesh.topology.index_map(dim)
    entities = np.arange(index_map.size_local + index_map.num_ghosts, dtype=np.int32)
    return entity_map.sub_topology_to_topology(entities, False)
