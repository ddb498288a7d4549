"""Trapped liquid, which no free surface feeds: where it is, and the volume that it lacks.

An incompressible pocket inside a shrinking shell would be squeezed to absurd pressures. It keeps
the pressure at which it closed instead, p = p_trapped, and its change of volume is booked: the
shrinkage porosity. A cell that freezes in a pocket is born with the volumetric strain that it has
there; else the shell would have to close the pocket in one step.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection, Sequence
from typing import Any

from mpi4py import MPI

import numpy as np
import ufl
from dolfinx import fem, la
from dolfinx import mesh as dmesh
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.domain.measures import cell_measure
from castx.domain.mesh import BodyMesh
from castx.forms.momentum import PointState
from castx.mechanics.constitutive.points import MaterialPoints
from castx.stateful import Arrays, Saved, Stateful, number

logger = logging.getLogger(__name__)

TRAPPED_SHARE = 1e-6
"""Weight of the equation p = p_trapped inside trapped liquid, in units of the solid's 1/K."""

Force = Sequence[float] | Callable[[Any], Any]


class Pockets:
    """Pressure and missing volume of the trapped liquid of one body.

    Args:
        body: mesh of the body.
        model: geometric model.
        closed: names of the surfaces through which no liquid can follow.
        body_force: on the liquid [N/m³]; a pocket that is closed from the start carries it by a
            hydrostatic pressure, unless it depends on the position.

    Attributes:
        trapped: one in the trapped cells of the trial step, else zero.
        pressure: pressure of trapped liquid at the nodes [Pa].
        volume: volume that trapped liquid has gained so far, the porosity [m³].
    """

    def __init__(
        self, body: BodyMesh, model: str, closed: Collection[str], body_force: Force = ()
    ) -> None:
        cells = fem.functionspace(body.mesh, ("DG", 0))
        self.trapped = fem.Function(cells)
        self.pressure = fem.Function(body.nodes)
        self.volume = 0.0
        self._body, self._comm = body, body.mesh.comm
        self._paths = FeedingPaths(body, model, closed)
        self._cell_nodes: IntArray = body.nodes.dofmap.list
        self._volumes = fem.assemble_vector(
            fem.form(ufl.TestFunction(cells) * cell_measure(body, model, 2))
        ).array[: cells.dofmap.index_map.size_local]
        self._was_trapped: BoolArray = np.zeros(len(self._cell_nodes), dtype=bool)
        self._closing_pressure: FloatArray = np.zeros(len(body.parent_vertices))
        self._last_pressure: FloatArray = _hydrostatic(body, body_force)
        self._last_dilatation: FloatArray = np.zeros(len(self._cell_nodes))
        self._born: FloatArray = np.zeros(len(self._cell_nodes))
        self._liquid: BoolArray = np.zeros(len(self._cell_nodes), dtype=bool)

    def state(self, points: PointState) -> PointState:
        """Return the state of the integration points, with the pressure of trapped liquid."""
        return points._replace(trapped=self.trapped, trapped_pressure=self.pressure)

    def begin(self, material: MaterialPoints) -> None:
        """Find the pockets of a trial step and set their compressibility and volume; collective."""
        trapped = self.update(~material.conditions.coherent)
        conditions = material.add_free_volume(self.birth_volume)
        # Little enough to leave the pressures of the shell alone.
        share = TRAPPED_SHARE * conditions.solid_compressibility[trapped]
        material.compressibility.x.array[trapped] = share

    def cell_pressures(self) -> FloatArray:
        """Return the pressures of the trapped cells [Pa], nan elsewhere, shape (cells,)."""
        trapped = self.trapped.x.array.astype(bool)
        return np.where(trapped, self.pressure.x.array[self._cell_nodes].mean(axis=1), np.nan)

    def update(self, liquid: BoolArray) -> BoolArray:
        """Find the trapped cells of a trial step and their pressures; collective.

        Args:
            liquid: whether a cell is a liquid, shape (cells,).

        Returns:
            Whether a cell is trapped, shape (cells,).
        """
        trapped = self._paths.trapped(liquid)
        self.trapped.x.array[:], self._liquid = trapped, liquid
        closing = np.zeros(len(self._closing_pressure), dtype=bool)
        closing[self._cell_nodes[trapped & ~self._was_trapped].ravel()] = True
        closing[self._cell_nodes[trapped & self._was_trapped].ravel()] = False
        self.pressure.x.array[:] = np.where(closing, self._last_pressure, self._closing_pressure)
        return trapped

    @property
    def birth_volume(self) -> FloatArray:
        """Volumetric strain at which the solid cells have no stress, shape (cells,)."""
        return np.where(self._liquid, 0.0, self._born)

    def commit(self, pressure: Callable[[], FloatArray], dilatation: FloatArray) -> None:
        """Book the volume that trapped cells gained in an accepted step; collective.

        Args:
            pressure: returns that at the local nodes [Pa], shape (nodes,).
            dilatation: volumetric strain of the cells, shape (cells,).
        """
        trapped = self.trapped.x.array.astype(bool)
        self._announce(trapped)
        growth = np.where(trapped, dilatation - self._last_dilatation, 0.0)
        gained = float(self._volumes @ growth[: len(self._volumes)])
        self.volume += self._comm.allreduce(gained, op=MPI.SUM)
        self._closing_pressure = self.pressure.x.array.copy()
        self._last_pressure, self._last_dilatation = pressure().copy(), dilatation.copy()
        self._was_trapped = trapped
        self._born = np.where(trapped, dilatation, self.birth_volume)

    def stateful_parts(self) -> dict[str, Stateful]:
        """Return the parts that a checkpoint keeps, by their name there."""
        return {"pockets": self}

    def saved(self) -> dict[str, Saved]:
        """Return the committed state and the volume gained so far."""
        nodes, cells = self._body.node_numbering, self._body.cell_numbering
        return {
            "volume": number(self.volume, bodies=(self._body.name,)),
            "trapped": Saved(self._was_trapped, cells),
            "dilatation": Saved(self._last_dilatation, cells),
            "born": Saved(self._born, cells),
            "pressure": Saved(self._last_pressure, nodes),
            "held_pressure": Saved(self._closing_pressure, nodes),
        }

    def restore(self, arrays: Arrays) -> None:
        """Restore a committed state."""
        self.volume = float(arrays["volume"])
        self._was_trapped = arrays["trapped"].astype(bool)
        self._last_dilatation = arrays["dilatation"].copy()
        self._born = arrays["born"].copy()
        self._last_pressure = arrays["pressure"].copy()
        self._closing_pressure = arrays["held_pressure"].copy()

    def _announce(self, trapped: BoolArray) -> None:
        new = trapped[: len(self._volumes)] & ~self._was_trapped[: len(self._volumes)]
        volume = self._comm.allreduce(float(self._volumes[new].sum()), op=MPI.SUM)
        if volume > 0:
            logger.info(
                "%s: %.3g m³ of liquid cannot be fed any more and keeps its pressure",
                self._body.name,
                volume,
            )


class NoPockets:
    """Stands for the pockets of a body that never is a liquid.

    Args:
        cells: number of cells of this rank.
    """

    volume = None

    def __init__(self, cells: int) -> None:
        self._cells = cells

    def state(self, points: PointState) -> PointState:
        """Return the state of the integration points as it is."""
        return points

    def begin(self, material: MaterialPoints) -> None:
        """Leave the material of a trial step as it is."""

    def cell_pressures(self) -> FloatArray:
        """Return nan, shape (cells,)."""
        return np.full(self._cells, np.nan)

    def commit(self, pressure: Callable[[], FloatArray], dilatation: FloatArray) -> None:
        """Book nothing."""

    def stateful_parts(self) -> dict[str, Stateful]:
        """Return nothing."""
        return {}


TrappedLiquid = Pockets | NoPockets


def _hydrostatic(body: BodyMesh, body_force: Force) -> FloatArray:
    """Return the pressures at rest [Pa], zero at the highest node, shape (nodes,)."""
    if callable(body_force) or len(body_force) == 0:
        return np.zeros(len(body.parent_vertices))
    head: FloatArray = body.points @ np.asarray(body_force[: body.points.shape[1]])
    lowest = body.mesh.comm.allreduce(float(head.min(initial=np.inf)), op=MPI.MIN)
    return np.asarray(lowest - head)


class FeedingPaths:
    """Finds the liquid cells of a body that are not connected to a free surface by liquid.

    Args:
        body: mesh of the body.
        model: geometric model; the axis of an axisymmetric body is no surface.
        closed: names of the surfaces through which no liquid can follow.
    """

    def __init__(self, body: BodyMesh, model: str, closed: Collection[str]) -> None:
        self._comm = body.mesh.comm
        self._cell_nodes: IntArray = body.nodes.dofmap.list
        self._nodes = len(body.parent_vertices)
        self._fed_nodes = la.vector(body.nodes.dofmap.index_map, 1, dtype=np.int8)
        self._at_free_surface = np.zeros(len(self._cell_nodes), dtype=bool)
        self._at_free_surface[_free_cells(body, model, closed)] = True

    def trapped(self, liquid: BoolArray) -> BoolArray:
        """Return which of the liquid cells are cut off from all free surfaces; collective.

        Args:
            liquid: the liquid cells of this rank, ghosts included, shape (cells,).
        """
        pocket = np.full(len(liquid), -1)
        count = 0
        if liquid.any():
            count, labels = self._regions(self._cell_nodes[liquid])
            pocket[liquid] = labels
        fed = np.zeros(count, dtype=bool)
        fed[pocket[liquid & self._at_free_surface]] = True
        while True:
            reached = self._reached(self._cell_nodes[liquid][fed[pocket[liquid]]])
            touched = reached[self._cell_nodes].any(axis=1) & liquid
            grown = fed.copy()
            grown[pocket[touched]] = True
            if not self._comm.allreduce(bool((grown != fed).any()), op=MPI.LOR):
                break
            fed = grown
        trapped = liquid.copy()
        trapped[liquid] = ~fed[pocket[liquid]]
        return trapped

    def _regions(self, cells: IntArray) -> tuple[int, IntArray]:
        """Return the number of connected regions of cells on this rank, and that of each cell."""
        number, corners = cells.shape
        rows = np.repeat(np.arange(number), corners)
        ones = np.ones(rows.size, dtype=np.int8)
        total = number + self._nodes
        joins = coo_matrix((ones, (rows, number + cells.ravel())), shape=(total, total))
        labels = connected_components(joins, directed=False)[1][:number]
        names, inverse = np.unique(labels, return_inverse=True)
        return len(names), inverse.astype(np.int32)

    def _reached(self, cells: IntArray) -> BoolArray:
        """Return which local nodes are corners of the given cells of any rank; collective."""
        flags = self._fed_nodes
        flags.array[:] = 0
        flags.array[cells.ravel()] = 1
        flags.scatter_reverse(la.InsertMode.add)
        flags.array[:] = flags.array != 0
        flags.scatter_forward()
        return flags.array.astype(bool)


def _free_cells(body: BodyMesh, model: str, closed: Collection[str]) -> IntArray:
    """Return the owned cells with a facet on a free surface."""
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
    cells = topology.connectivity(dimension - 1, dimension)
    first = cells.offsets[free]
    return np.asarray(cells.array[first], dtype=np.int32)
