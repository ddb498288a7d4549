"""All differences between versions of DOLFINx and PETSc, and between where they come from."""

from __future__ import annotations

import logging
import re
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

from mpi4py import MPI
from petsc4py import PETSc

import basix.ufl
import dolfinx
import numpy as np
import ufl
from dolfinx.fem import FunctionSpace
from dolfinx.graph import adjacencylist
from dolfinx.mesh import Mesh

from castx.arrays import FloatArray, IntArray, LongArray

Partitioner = Callable[..., Any]
log = logging.getLogger(__name__)

TESTED = ((0, 9), (0, 11))
"""The oldest and the newest DOLFINx with which the tests of castx are run."""


def version_warning(version: str) -> str | None:
    """Return a warning about a DOLFINx that castx is not tested with, or None.

    Args:
        version: of DOLFINx, such as "0.11.0.post0".
    """
    numbers = re.match(r"(\d+)\.(\d+)", version)
    oldest, newest = TESTED
    if numbers and oldest <= (int(numbers[1]), int(numbers[2])) <= newest:
        return None
    oldest_text, newest_text = (".".join(map(str, tested)) for tested in TESTED)
    return (
        f"DOLFINx {version} is not among the versions that castx is tested with, "
        f"{oldest_text} to {newest_text}: compare a case whose results you know"
    )


def not_finite() -> PETSc.SNES.ConvergedReason:
    """Return the reason of a nonlinear solver that ends at numbers which are not finite."""
    reasons = PETSc.SNES.ConvergedReason
    return getattr(reasons, "DIVERGED_FUNCTION_NANORINF", None) or reasons.DIVERGED_FNORM_NAN


@contextmanager
def kept_signals() -> Iterator[None]:
    """Give signals the handlers of Python again that a library inside takes from them.

    The gmsh of PyPI brings a PETSc of its own, which at its end leaves none: a run that is told to
    stop would die without its last state.
    """
    try:
        yield
    finally:
        if threading.current_thread() is threading.main_thread():
            for number in signal.valid_signals():
                handler = signal.getsignal(number)
                if callable(handler) or handler is signal.SIG_IGN:
                    signal.signal(number, handler)


@cache
def _warn_of_untested_version() -> None:
    if warning := version_warning(dolfinx.__version__):
        log.warning(warning)


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
    if comm.rank == 0:
        _warn_of_untested_version()
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


def geometry_nodes(mesh: Mesh) -> IntArray:
    """Return the points of the local cells, indices into `mesh.geometry.x`, (cells, corners)."""
    dofmaps = getattr(mesh.geometry, "dofmaps", None)  # 0.11: one for each kind of cell
    return np.asarray(dofmaps[0] if isinstance(dofmaps, list) else mesh.geometry.dofmap)


def interpolation_points(space: FunctionSpace) -> FloatArray:
    """Return the points of the reference cell at which an element takes values, (points, tdim)."""
    points = space.element.interpolation_points  # a method until 0.9, an array since
    return np.asarray(points() if callable(points) else points)


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
    parents: IntArray = entity_map.sub_topology_to_topology(entities, False)
    return parents
