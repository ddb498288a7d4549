"""Displacement that the mid-sides of a body have beyond the means of the ends of their edges."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import basix
import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem

from castx.arrays import FloatArray, IntArray, LongArray
from castx.domain.measures import summed_over_ranks
from castx.domain.mesh import BodyMesh
from castx.forms import kinematics
from castx.mechanics.midsides.bubbles import bubble_element
from castx.stateful import Numbering


class Midsides:
    """The mid-sides of one body and their unknowns: the edge bubbles of the displacement.

    Args:
        body: mesh of the body, of triangles or tetrahedra.
        model: geometric model.

    Attributes:
        block_size: unknowns of a mid-side, the components of the displacement.
        space: functions spanned by the edge bubbles.
        solution: present values of the unknowns [m].
        cell_midsides: local mid-sides of the cells, shape (cells, edges).
        ends: local nodes at the ends of the edges, shape (mid-sides, 2).
    """

    def __init__(self, body: BodyMesh, model: str) -> None:
        self._body, self._model = body, model
        self.block_size: int = body.mesh.geometry.dim
        body.mesh.topology.create_entities(1)
        self.space = fem.functionspace(body.mesh, bubble_element(body.kind.name, self.block_size))
        self.solution = fem.Function(self.space, name=f"mid-sides of {body.name}")
        self.cell_midsides: IntArray = self.space.dofmap.list
        edges = np.array(basix.topology(getattr(basix.CellType, body.kind.name))[1])
        self.ends: IntArray = np.zeros((self.count, 2), dtype=np.int32)
        self.ends[self.cell_midsides] = body.nodes.dofmap.list[:, edges]

    @property
    def _index_map(self) -> Any:
        return self.space.dofmap.index_map

    @property
    def count(self) -> int:
        """Number of local mid-sides."""
        return int(self._index_map.size_local + self._index_map.num_ghosts)

    @property
    def owned_cells(self) -> int:
        """Number of cells that this rank owns."""
        return self._body.cell_numbering.owned

    @property
    def owned_midsides(self) -> int:
        """Number of mid-sides that this rank owns."""
        return int(self._index_map.size_local)

    @property
    def owned(self) -> int:
        """Number of unknowns that this rank owns."""
        return self.owned_midsides * self.block_size

    def displacement(self, w: Any) -> Any:
        """Return the displacement in unknowns or in a test or trial function w."""
        return w

    def strain(self, w: Any) -> Any:
        """Return the strain of unknowns or of a test or trial function, shape (3, 3)."""
        return kinematics.strain(w, self._model, ufl.SpatialCoordinate(self._body.mesh))

    @property
    def numbering(self) -> Numbering:
        """The local mid-sides by the numbers of their ends before the mesh was distributed."""
        nodes = self._body.original_nodes
        comm = self._body.mesh.comm
        most = comm.allreduce(int(nodes.max(initial=0)), op=MPI.MAX) + 1
        ends = np.sort(nodes[self.ends], axis=1)
        name = self._body.name
        return Numbering(
            f"mid-sides of {name}", ends[:, 0] * most + ends[:, 1], self.owned_midsides, (name,)
        )

    def on_surface(self, name: str) -> IntArray:
        """Return the local mid-sides of a surface, ghosts included, ascending; collective.

        Raises:
            MeshError: the body has no such surface.
        """
        facets = self._body.facet_tags.find(self._body.surface_tag(name))
        dimension = self._body.mesh.topology.dim - 1
        here = fem.locate_dofs_topological(self.space, dimension, facets, remote=False)
        marks = np.zeros(self.count)
        marks[here] = 1.0
        return np.flatnonzero(self.sum(marks)).astype(np.int32)

    def at_edges(self, surface: str, ends: LongArray) -> LongArray:
        """Return the global mid-sides of edges of a surface, whichever rank owns them; collective.

        Args:
            surface: name of the surface.
            ends: global nodes at the ends of the edges, shape (n, 2).
        """
        here = self.on_surface(surface)
        here = here[here < self.owned_midsides]
        nodes = self._body.nodes.dofmap.index_map
        own = nodes.local_to_global(self.ends[here].ravel()).reshape(-1, 2)
        mine = _keys(own, nodes.size_global), self._index_map.local_to_global(here)
        everywhere = zip(*self._body.mesh.comm.allgather(mine), strict=True)
        keys, numbers = (np.concatenate(parts) for parts in everywhere)
        order = np.argsort(keys)
        place = np.searchsorted(keys[order], _keys(ends, nodes.size_global))
        return np.asarray(numbers[order][place], dtype=np.int64)

    def sum(self, values: npt.NDArray[Any]) -> FloatArray:
        """Return the sums over all ranks of values at the local mid-sides; collective."""
        return summed_over_ranks(self._index_map, values)


def _keys(ends: LongArray, nodes: int) -> LongArray:
    """Return one number for each pair of nodes, in either order."""
    return np.asarray(ends.min(axis=1) * nodes + ends.max(axis=1), dtype=np.int64)
