"""Surfaces through which melt is fed while they are mushy, and the pressure on the melt there.

The melt of a feeder stands as high as the highest point of its surface, z, at first, and sinks by d
(`castx.mechanics.mush.levels`). At a node of height z_i the pressure on it is

    P = gas + ρ g (z − d − z_i),

so that p_i = −P, and the head is a traction −P n on the surface too, which would creep otherwise.
The pressure of the gas is the one that the case puts on a surface, and acts there already; a
traction acts on the skeleton and leaves the melt at zero. A frozen node is shut.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any

from mpi4py import MPI

import numpy as np
import ufl
from dolfinx import fem
from dolfinx import mesh as dmesh

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.domain.measures import nodal_sum
from castx.domain.mesh import BodyMesh
from castx.forms import kinematics, momentum
from castx.mechanics.liquid.feeding_paths import free_facets

ALL = "free"
"""Name of the feeder that all free surfaces are together."""


class FedNodes:
    """The surfaces of a body that feed, and their nodes.

    Args:
        body: mesh of the body.
        model: geometric model.
        feeders: names of the surfaces that feed, each with a level; None: all that are free, with
            one level.
        closed: names of the surfaces that are not free.
        force: the body force b [N/m³], shape (dimension,).
        pressures: returns the pressures that push on surfaces at the present time [Pa], of each one
            number or those of its local nodes.

    Attributes:
        nodes: whether the local nodes are fed in the trial step, shape (nodes,).
        names: of the feeders.
        feeder: number of the feeder of each local node, −1: none, shape (nodes,).
        areas: horizontal areas of the feeders [m²], shape (feeders,).
        volumes: of a level at the nodes of feeders that sink, over the change of the pressure
            there [m³/Pa], elsewhere infinite, shape (nodes,).
    """

    def __init__(
        self,
        body: BodyMesh,
        model: str,
        feeders: Collection[str] | None,
        closed: Collection[str],
        force: FloatArray,
        pressures: Callable[[], Mapping[str, float | FloatArray]],
    ) -> None:
        self._pressures, self._body = pressures, body
        self._pressed = {name: body.surface_nodes(name) for name in pressures()}
        self._weight = float(np.linalg.norm(force))
        self._potential = body.points[:, : len(force)] @ force
        nodes = len(body.parent_vertices)
        self.nodes: BoolArray = np.zeros(nodes, dtype=bool)
        self.names = (ALL,) if feeders is None else tuple(feeders)
        self.feeder: IntArray = np.full(nodes, -1, dtype=np.int32)
        self._full: FloatArray = np.zeros(nodes)
        self.areas: FloatArray = np.zeros(len(self.names))
        self._head = fem.Function(body.nodes)
        found: list[IntArray] = [np.zeros(0, dtype=np.int32)]
        for number, name in enumerate(self.names):
            if feeders is None:
                facets = free_facets(body, model, closed)
            else:
                facets = body.facet_tags.find(body.surface_tag(name))
            self._add(number, facets)
            self.areas[number] = self._area(_measure(body, model, facets), force)
            found.append(facets)
        self._measure = _measure(body, model, np.concatenate(found))
        self.volumes = self._volumes()

    def _add(self, number: int, facets: IntArray) -> None:
        """Give a feeder its nodes and its level; collective."""
        marked, edge = np.zeros(len(self.nodes)), self._body.mesh.topology.dim - 1
        marked[fem.locate_dofs_topological(self._body.nodes, edge, facets)] = 1.0
        nodes = (nodal_sum(self._body, marked) > 0.0) & (self.feeder < 0)
        lowest = float(self._potential[nodes].min(initial=np.inf))
        lowest = self._body.mesh.comm.allreduce(lowest, op=MPI.MIN)
        self._full[nodes] = self._potential[nodes] - lowest
        self.feeder[nodes] = number

    def _area(self, ds: Any, force: FloatArray) -> float:
        """Return the horizontal area of a surface [m²], zero without weight; collective."""
        if self._weight == 0.0:
            return 0.0
        down = ufl.as_vector((force / self._weight).tolist())
        faces_up = ufl.max_value(-ufl.inner(ufl.FacetNormal(self._body.mesh), down), 0.0)
        here = float(fem.assemble_scalar(fem.form(faces_up * ds)))
        return float(self._body.mesh.comm.allreduce(here, op=MPI.SUM))

    def _volumes(self) -> FloatArray:
        """Return `volumes`, the areas in equal parts to all nodes of a feeder; collective."""
        owned = int(self._body.nodes.dofmap.index_map.size_local)
        belongs = self.feeder[:owned][self.feeder[:owned] >= 0]
        counts = np.bincount(belongs, minlength=len(self.areas))
        counts = self._body.mesh.comm.allreduce(counts, op=MPI.SUM)
        parts = np.where(self.areas > 0.0, self.areas, np.inf) / np.maximum(counts, 1)
        weight = self._weight if self._weight > 0.0 else 1.0
        return np.append(parts, np.inf)[self.feeder] / weight

    def begin(self, liquid: FloatArray, cut_off: float) -> None:
        """Find the nodes that are fed in a step, and their heads.

        Args:
            liquid: liquid fraction of the local nodes at the start of the step, shape (nodes,).
            cut_off: g_c, below which a surface is shut.
        """
        self.nodes = (self.feeder >= 0) & (liquid > cut_off)

    def head(self, drops: FloatArray) -> FloatArray:
        """Return ρ g (z − d − z_i) at fed nodes, else zero [Pa], shape (nodes,).

        Args:
            drops: d of the feeders [m], shape (feeders,).
        """
        sunk = np.append(drops, 0.0)[self.feeder]
        return np.where(self.nodes, self._full - self._weight * sunk, 0.0)

    def mean_stress(self, drops: FloatArray) -> FloatArray:
        """Return −P at the local nodes [Pa], shape (nodes,), argument as for `head`."""
        found = -self.head(drops)
        for name, pressure in self._pressures().items():
            found[self._pressed[name]] -= pressure
        return np.asarray(found)

    def use(self, head: FloatArray) -> None:
        """Let a head at the local nodes [Pa], shape (nodes,), act in `virtual_work`."""
        self._head.x.array[:] = head

    def of_metre(self, number: int) -> FloatArray:
        """Return the change of the head for a fall of one feeder by a metre [Pa], (nodes,)."""
        return np.where(self.nodes & (self.feeder == number), -self._weight, 0.0)

    def virtual_work(self, eta: Any) -> Any:
        """Return −∫_Γ P η·n of the head of `use` for a variation η."""
        normal = ufl.FacetNormal(self._body.mesh)
        return momentum.pressure_work(eta, self._head, normal, self._measure)


def _measure(body: BodyMesh, model: str, facets: IntArray) -> Any:
    """Return the weighted measure of some facets."""
    found = np.unique(facets).astype(np.int32)
    edge = body.mesh.topology.dim - 1
    tags = dmesh.meshtags(body.mesh, edge, found, np.ones(len(found), dtype=np.int32))
    weight = kinematics.weight(model, ufl.SpatialCoordinate(body.mesh))
    data = {"quadrature_degree": 2}
    measure = ufl.Measure("ds", domain=body.mesh, subdomain_data=tags, metadata=data)
    return kinematics.WeightedMeasure(weight, measure)(1)
