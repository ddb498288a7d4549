"""Liquid that is cut off: which cells of a body no liquid joins to a free surface."""

from __future__ import annotations

from collections.abc import Collection

from mpi4py import MPI

import numpy as np
from dolfinx import mesh as dmesh

from castx.arrays import BoolArray, IntArray
from castx.domain.mesh import BodyMesh
from castx.mechanics.liquid.regions import CellRegions


class FeedingPaths:
    """Finds the liquid cells of a body that are not connected to a free surface by liquid.

    Args:
        body: mesh of the body.
        model: geometric model; the axis of an axisymmetric body is no surface.
        closed: names of the surfaces through which no liquid can follow.
    """

    def __init__(self, body: BodyMesh, model: str, closed: Collection[str]) -> None:
        self._regions = CellRegions(body)
        self._at_free_surface = np.zeros(len(body.nodes.dofmap.list), dtype=bool)
        self._at_free_surface[_free_cells(body, model, closed)] = True

    def pockets(self, liquid: BoolArray) -> IntArray:
        """Return the number of the pocket of each cell, −1: none, shape (cells,); collective.

        A pocket is a set of liquid cells joined by their corners and by none of them to a free
        surface; all ranks have the same numbers.

        Args:
            liquid: the liquid cells of this rank, ghosts included, shape (cells,).
        """
        count, region = self._regions.find(liquid)
        fed = np.zeros(count, dtype=np.int32)
        fed[region[liquid & self._at_free_surface]] = 1
        self._regions.comm.Allreduce(MPI.IN_PLACE, fed, op=MPI.MAX)
        number = np.where(fed > 0, -1, np.cumsum(fed == 0) - 1)
        pocket = np.full(len(liquid), -1, dtype=np.int32)
        pocket[liquid] = number[region[liquid]]
        return pocket


def free_facets(body: BodyMesh, model: str, closed: Collection[str]) -> IntArray:
    """Return the owned facets on a free surface of a body, arguments as for `FeedingPaths`."""
    topology, dimension = body.mesh.topology, body.mesh.topology.dim
    outer = dmesh.exterior_facet_indices(topology)
    shut = [body.facet_tags.find(body.surfaces[name]) for name in closed]
    free = np.setdiff1d(outer, np.concatenate([np.zeros(0, dtype=np.int32), *shut]))
    if model == "axisymmetric":
        largest = np.abs(body.mesh.geometry.x[:, 0]).max(initial=0.0)
        on_axis = dmesh.locate_entities(
            body.mesh, dimension - 1, lambda x: np.abs(x[0]) < 1e-9 * largest
        )
        free = np.setdiff1d(free, on_axis)
    return np.asarray(free, dtype=np.int32)


def _free_cells(body: BodyMesh, model: str, closed: Collection[str]) -> IntArray:
    """Return the owned cells with a facet on a free surface."""
    free = free_facets(body, model, closed)
    topology, dimension = body.mesh.topology, body.mesh.topology.dim
    cells = topology.connectivity(dimension - 1, dimension)
    first = cells.offsets[free]
    return np.asarray(cells.array[first], dtype=np.int32)
