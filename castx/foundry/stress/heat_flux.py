"""Heat flux -k∇T in the cells of all bodies, by the potential θ = ∫k dT of the heat equation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from castx.arrays import FloatArray
from castx.case.case import Case
from castx.foundry.front.gradients import midpoint_gradients
from castx.materials.conduction_potential import ConductionPotential, conduction_potential
from castx.materials.lookup import find_material
from castx.stateful import Arrays, Saved

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh, CastingMesh

HEAT_FLUX = "heat_flux"
"""Name of the field."""


class HotState(Protocol):
    """The part of a state after an accepted step that is needed here."""

    @property
    def mesh(self) -> CastingMesh:
        """The bodies that are there."""

    def nodal(self, body: str, name: str, /) -> FloatArray:
        """Return a nodal field with ghosts."""


class HeatFluxes:
    """The heat flux of the last state.

    Args:
        mesh: of all bodies.
        potentials: of the bodies whose flux is asked for, by name.
    """

    def __init__(self, mesh: CastingMesh, potentials: Mapping[str, ConductionPotential]) -> None:
        self._potentials = potentials
        self._cells = {name: cells_of(mesh.bodies[name]) for name in potentials}
        self._gradients = {
            name: midpoint_gradients(mesh.bodies[name].nodes, mesh.bodies[name].points[cells])[0]
            for name, cells in self._cells.items()
        }
        self._temperatures: dict[str, FloatArray] = {}

    def update(self, state: HotState) -> None:
        """Take over the state after an accepted step."""
        for name in self._potentials:
            if name in state.mesh.bodies:
                self._temperatures[name] = state.nodal(name, "temperature").copy()

    def field(self, body: str, name: str) -> FloatArray | None:
        """Return -k∇T in the middles of the local cells, (cells, gdim) [W/m²]; None: unknown."""
        if name != HEAT_FLUX or body not in self._temperatures:
            return None
        potential = self._potentials[body](self._temperatures[body])
        at_corners = potential[self._cells[body]]
        return np.asarray(-np.einsum("cak,ca->ck", self._gradients[body], at_corners))

    def totals(self) -> dict[str, float]:
        """Return nothing: the heat of bodies and interfaces is counted elsewhere."""
        return {}

    def described(self) -> dict[str, Any]:
        """Return nothing."""
        return {}

    def saved(self) -> dict[str, Saved]:
        """Return nothing: the flux belongs to the last state."""
        return {}

    def restore(self, arrays: Arrays) -> None:
        """Have nothing to restore."""


def cells_of(body: BodyMesh) -> FloatArray:
    """Return the nodes of the local cells of a body, (cells, corners)."""
    return np.asarray(body.nodes.dofmap.list)


def heat_fluxes_of(case: Case, mesh: CastingMesh) -> HeatFluxes:
    """Return the heat flux of all bodies of a case, of none if it is not asked for."""
    if HEAT_FLUX not in case.output.fields:
        return HeatFluxes(mesh, {})
    materials = {body.name: find_material(body.material, case.materials) for body in case.bodies}
    return HeatFluxes(mesh, {n: conduction_potential(m) for n, m in materials.items()})
