"""Nodes through which melt is fed: on free surfaces or named feeders, while they are mushy."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping

import numpy as np
from dolfinx import fem

from castx.arrays import BoolArray, FloatArray
from castx.domain.measures import nodal_sum
from castx.domain.mesh import BodyMesh
from castx.mechanics.liquid.feeding_paths import free_facets


class FedNodes:
    """The nodes of a body on surfaces that feed, and the pressure on the melt there.

    A pressure on such a surface is that of the gas above the melt; a traction acts on the skeleton
    and leaves the melt at zero.

    Args:
        body: mesh of the body.
        model: geometric model.
        feeders: names of the surfaces that feed; None: all that are free.
        closed: names of the surfaces that are not free.
        pressures: returns the pressures that push on surfaces at the present time [Pa].
    """

    def __init__(
        self,
        body: BodyMesh,
        model: str,
        feeders: Collection[str] | None,
        closed: Collection[str],
        pressures: Callable[[], Mapping[str, float]],
    ) -> None:
        self._pressures = pressures
        self._at_surface: BoolArray = np.zeros(len(body.parent_vertices), dtype=bool)
        if feeders is None:
            marked = np.zeros(len(self._at_surface))
            facets = free_facets(body, model, closed)
            edge = body.mesh.topology.dim - 1
            marked[fem.locate_dofs_topological(body.nodes, edge, facets)] = 1.0
            self._at_surface = nodal_sum(body, marked) > 0.0
        for name in feeders or ():
            self._at_surface[body.surface_nodes(name)] = True
        self._pressed = {name: body.surface_nodes(name) for name in pressures()}
        self.nodes: BoolArray = np.zeros_like(self._at_surface)

    def begin(self, liquid: FloatArray, cut_off: float) -> None:
        """Find the nodes that are fed in a step.

        Args:
            liquid: liquid fraction of the local nodes at the start of the step, shape (nodes,).
            cut_off: g_c, below which a surface is shut.
        """
        self.nodes = self._at_surface & (liquid > cut_off)

    def mean_stress(self) -> FloatArray:
        """Return −P at the local nodes [Pa], shape (nodes,)."""
        found = np.zeros(len(self.nodes))
        for name, pressure in self._pressures().items():
            found[self._pressed[name]] = -pressure
        return found
