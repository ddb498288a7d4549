"""Surfaces through which melt is fed while they are mushy, and the pressure on the melt there.

The melt of a feeder stands as high as the highest point of its surface, z. At a node of height z_i
the pressure on it is

    P = gas + ρ g (z − z_i),

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


class FedNodes:
    """The surfaces of a body that feed, and their nodes.

    Args:
        body: mesh of the body.
        model: geometric model.
        feeders: names of the surfaces that feed, each with a level; None: all that are free, with
            one level.
        closed: names of the surfaces that are not free.
        potential: x·b of the body force b at the local nodes [Pa], shape (nodes,).
        pressures: returns the pressures that push on surfaces at the present time [Pa].

    Attributes:
        nodes: whether the local nodes are fed in the trial step, shape (nodes,).
        head: ρ g (z − z_i) at fed nodes, else zero [Pa].
    """

    def __init__(
        self,
        body: BodyMesh,
        model: str,
        feeders: Collection[str] | None,
        closed: Collection[str],
        potential: FloatArray,
        pressures: Callable[[], Mapping[str, float]],
    ) -> None:
        self._pressures = pressures
        self._pressed = {name: body.surface_nodes(name) for name in pressures()}
        if feeders is None:
            facets = [free_facets(body, model, closed)]
        else:
            facets = [body.facet_tags.find(body.surface_tag(name)) for name in feeders]
        self.nodes: BoolArray = np.zeros(len(potential), dtype=bool)
        self._at_surface, self._full = self.nodes.copy(), np.zeros(len(potential))
        for surface in facets:
            self._add(body, surface, potential)
        self.head = fem.Function(body.nodes)
        self._measure = _measure(body, model, np.concatenate([np.zeros(0, np.int32), *facets]))

    def _add(self, body: BodyMesh, facets: IntArray, potential: FloatArray) -> None:
        """Add a feeder with a level of its own; collective."""
        marked = np.zeros(len(potential))
        edge = body.mesh.topology.dim - 1
        marked[fem.locate_dofs_topological(body.nodes, edge, facets)] = 1.0
        nodes = nodal_sum(body, marked) > 0.0
        lowest = float(potential[nodes].min(initial=np.inf))
        lowest = body.mesh.comm.allreduce(lowest, op=MPI.MIN)
        self._full[nodes] = potential[nodes] - lowest
        self._at_surface |= nodes

    def begin(self, liquid: FloatArray, cut_off: float) -> None:
        """Find the nodes that are fed in a step, and their heads.

        Args:
            liquid: liquid fraction of the local nodes at the start of the step, shape (nodes,).
            cut_off: g_c, below which a surface is shut.
        """
        self.nodes = self._at_surface & (liquid > cut_off)
        self.head.x.array[:] = np.where(self.nodes, self._full, 0.0)

    def mean_stress(self) -> FloatArray:
        """Return −P at the local nodes [Pa], shape (nodes,)."""
        found = -self.head.x.array
        for name, pressure in self._pressures().items():
            found[self._pressed[name]] -= pressure
        return found

    def virtual_work(self, eta: Any) -> Any:
        """Return −∫_Γ ρ g (z − z_i) η·n for a variation η."""
        normal = ufl.FacetNormal(self.head.function_space.mesh)
        return momentum.pressure_work(eta, self.head, normal, self._measure)


def _measure(body: BodyMesh, model: str, facets: IntArray) -> Any:
    """Return the weighted measure of some facets."""
    found = np.unique(facets).astype(np.int32)
    edge = body.mesh.topology.dim - 1
    tags = dmesh.meshtags(body.mesh, edge, found, np.ones(len(found), dtype=np.int32))
    weight = kinematics.weight(model, ufl.SpatialCoordinate(body.mesh))
    data = {"quadrature_degree": 2}
    measure = ufl.Measure("ds", domain=body.mesh, subdomain_data=tags, metadata=data)
    return kinematics.WeightedMeasure(weight, measure)(1)
