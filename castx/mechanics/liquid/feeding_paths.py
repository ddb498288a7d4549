"""Liquid that is cut off: which cells of a body no liquid joins to a free surface.

It flows from node to node, as long as the solid fraction there lets it.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Collection
from functools import cache, partial
from typing import Any, NamedTuple

from mpi4py import MPI

import numpy as np
from dolfinx import mesh as dmesh
from numpy.typing import NDArray

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.domain.measures import nodes_on_facets
from castx.domain.mesh import BodyMesh
from castx.mechanics.liquid.regions import CellRegions

LATEST = 0.999
"""Part of a step after which liquid is cut off at the latest: with nothing left of the step, the
motion of its walls from then on would be no share of their motion in it."""


class CutOff(NamedTuple):
    """Cells of a body that no liquid reaches at the end of a step, and since when in it.

    Attributes:
        region: number of the cut-off region of each cell, −1: none, shape (cells,).
        moment: part of the step after which a cell was cut off that was fed at its start, zero for
            all others, likewise.
        group: number of the region in which such a cell was cut off, −1: it was fed until the end
            or until it had frozen, or was not at the start, likewise.
        groups: number of these regions.
    """

    region: IntArray
    moment: FloatArray
    group: IntArray
    groups: int

    @classmethod
    def throughout(cls, region: IntArray) -> CutOff:
        """Return regions that were cut off, or fed, throughout the step."""
        return cls(region, np.zeros(len(region)), np.full_like(region, -1), 0)


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

    def cut_off(
        self, before: FloatArray, fraction: FloatArray, fed_until: float, fed: BoolArray
    ) -> CutOff:
        """Return the cells that are cut off at the end of a step, and since when; collective.

        All ranks number the regions alike. When a path froze follows from solid fractions that grow
        evenly in the step: what freezes in a pool that is cut off in a long step would otherwise be
        booked on the wrong side of the cut.

        Args:
            before: solid fraction at the local nodes at the start of the step, shape (nodes,).
            fraction: at its end, likewise.
            fed_until: solid fraction up to which liquid can flow; not in what is all solid.
            fed: whether each cell was not cut off at the start, shape (cells,).
        """
        region = self.pockets(fraction, fed_until)
        corners = self._regions.cell_nodes
        fed = fed & _wet(before, fed_until)[corners].any(axis=1)
        closing = _closing_moments(before, fraction, fed_until)
        moments = self._numbers(np.append(closing[(closing >= 0.0) & (closing <= 1.0)], 0.0))
        behind = cache(lambda moment: self._pockets_of(closing > moment))
        found = self._dated(CutOff.throughout(region), region, fed, moments, behind)
        if len(moments) == 1:
            return found
        # Pools that end in the step; those behind its last but one closing are all that matter.
        return self._dated(found, behind(moments[-2]), fed, moments[:-1], behind)

    def _dated(
        self,
        found: CutOff,
        there: IntArray,
        fed: BoolArray,
        moments: FloatArray,
        behind: Callable[[float], IntArray],
    ) -> CutOff:
        """Return cut-off cells with the moments at which some pools lost their paths; collective.

        Args:
            found: so far.
            there: pockets of the cells at some time.
            fed: whether each cell held liquid that was fed at the start of the step.
            moments: at which paths may close, in their order, the pools at last being cut off.
            behind: returns pockets behind a moment.
        """
        groups = found.groups
        for pool in self._numbers(there[fed & (found.group < 0) & (there >= 0)]):
            cells = fed & (there == pool)
            first = bisect_left(moments[:-1], True, key=partial(self._is_cut, behind, cells))
            pockets = behind(moments[first])
            same = np.isin(pockets, self._numbers(pockets[cells]))
            own = fed & (found.group < 0) & same & (pockets >= 0)
            found.group[own], found.moment[own] = groups, min(moments[first], LATEST)
            groups += 1
        return found._replace(groups=groups)

    def _numbers(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return the numbers that any rank has, each once and in their order; collective."""
        every = self._regions.comm.allgather(np.unique(values))
        return np.asarray(np.unique(np.concatenate(every)))

    def _is_cut(self, behind: Callable[[float], IntArray], cells: BoolArray, moment: float) -> bool:
        """Return whether none of some cells is fed behind a moment, on any rank; collective."""
        fed = bool((behind(moment)[cells] < 0).any())
        return not self._regions.comm.allreduce(fed, op=MPI.LOR)

    def pockets(self, fraction: FloatArray, fed_until: float) -> IntArray:
        """Return the number of the pocket of each cell, −1: none, shape (cells,); collective.

        A pocket is a set of cells joined by nodes where liquid can flow, none of which lies on a
        free surface; all ranks have the same numbers.

        Args:
            fraction: solid fraction at the local nodes, shape (nodes,).
            fed_until: solid fraction up to which liquid can flow; not in what is all solid.
        """
        return self._pockets_of(_wet(fraction, fed_until))

    def _pockets_of(self, wet: BoolArray) -> IntArray:
        """Return the same by the nodes where liquid can flow, shape (nodes,)."""
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


def _wet(fraction: FloatArray, fed_until: float) -> BoolArray:
    # With metal that bears from f_c on, a node either bears or lets liquid flow.
    return (fraction <= fed_until) & (fraction < 1.0)


def _closing_moments(before: FloatArray, fraction: FloatArray, fed_until: float) -> FloatArray:
    """Return the part of a step after which a node lets no liquid flow.

    It is infinite where liquid flows at the end, and minus infinity where it does at neither. When
    metal in which liquid flows until it is solid ended to freeze, its solid fraction does not tell.
    """
    found = np.where(_wet(fraction, fed_until), np.inf, -np.inf)
    freezes = _wet(before, fed_until) & ~_wet(fraction, fed_until)
    part = (fed_until - before[freezes]) / (fraction - before)[freezes]
    found[freezes] = part if fed_until < 1.0 else 0.5
    return found


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
