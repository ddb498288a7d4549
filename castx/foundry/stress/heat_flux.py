"""Heat flux -k∇T in the cells of all bodies at the last state."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

from castx.arrays import FloatArray
from castx.case.case import Case
from castx.discretisation.cell_flux import CellHeatFlux, potentials_of
from castx.materials.conduction_potential import ConductionPotential
from castx.stateful import Arrays, Saved

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh

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
        self._fluxes = {n: CellHeatFlux(mesh.bodies[n], of) for n, of in potentials.items()}
        self._temperatures: dict[str, FloatArray] = {}

    def update(self, state: HotState) -> None:
        """Take over the state after an accepted step."""
        for name in self._fluxes:
            if name in state.mesh.bodies:
                self._temperatures[name] = state.nodal(name, "temperature").copy()

    def field(self, body: str, name: str) -> FloatArray | None:
        """Return -k∇T in the middles of the local cells, (cells, gdim) [W/m²]; None: unknown."""
        if name != HEAT_FLUX or body not in self._temperatures:
            return None
        return self._fluxes[body](self._temperatures[body])

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


def heat_fluxes_of(case: Case, mesh: CastingMesh) -> HeatFluxes:
    """Return the heat flux of all bodies of a case, of none if it is not asked for."""
    asked = HEAT_FLUX in case.output.fields
    return HeatFluxes(mesh, potentials_of(case) if asked else {})
