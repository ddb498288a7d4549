"""Liquid that is cut off: which cells of a body no liquid joins to a free surface.

It flows from node to node, as long as the solid fraction there lets it.
"""

from __future__ import annotations

from collections.abc import Collection

from mpi4py import MPI

import numpy as np
from dolfinx import mesh as dmesh

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.domain.measures import nodes_on_facets
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
        self._at_free_surface = nodes_on_facets(body, free_facets(body, model, closed))

    def pockets(self, fraction: FloatArray, fed_until: float) -> IntArray:
        """Return the number of the pocket of each cell, −1: none, shape (cells,); collective.

        A pocket is a set of cells joined by nodes where liquid can flow, none of which lies on a
        free surface; all ranks have the same numbers.

        Args:
            fraction: solid fraction at the local nodes, shape (nodes,).
            fed_until: solid fraction up to which liquid can flow; not in what is all solid.
        """
        # With metal that bears from f_c on, a node either bears or lets liquid flow.
        wet = (fraction <= fed_until) & (fraction < 1.0)
        corners = self._regions.cell_nodes
        inside: BoolArray = np.asarray(wet[corners].any(axis=1))
        count, region = self._regions.find(inside, wet)
        fed = np.zeros(count, dtype=np.int32)
        fed[region[inside & (wet & self._at_free_surface)[corners].any(axis=1)]] = 1
        self._regions.comm.Allreduce(MPI.IN_PLACE, fed, op=MPI.MAX)
        number = np.where(fed > 0, -1, np.cumsum(fed == 0) - 1)
        pocket = np.full(len(inside), -1, dtype=np.int32)
        pocket[inside] = number[region[inside]]
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
