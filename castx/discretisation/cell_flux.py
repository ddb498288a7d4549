"""Heat flux -k∇T in the cells of a body, by the potential θ = ∫ k dT of the heat equation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from castx.arrays import FloatArray
from castx.case.case import Case
from castx.foundry.front.gradients import midpoint_gradients
from castx.materials.conduction_potential import ConductionPotential, conduction_potential
from castx.materials.lookup import find_material

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh


class CellHeatFlux:
    """Heat flux in the middles of the local cells of a body.

    Args:
        body: its mesh.
        potential: of its material.
    """

    def __init__(self, body: BodyMesh, potential: ConductionPotential) -> None:
        self._cells, self._potential = body.nodes.dofmap.list, potential
        self._gradients = midpoint_gradients(body.nodes, body.points[self._cells])[0]

    def __call__(self, temperature: FloatArray) -> FloatArray:
        """Return -k∇T, (cells, gdim) [W/m²].

        Args:
            temperature: at the local nodes, (nodes,) [°C].
        """
        at_corners = self._potential(temperature)[self._cells]
        return np.asarray(-np.einsum("cak,ca->ck", self._gradients, at_corners))


def potentials_of(case: Case) -> dict[str, ConductionPotential]:
    """Return the potentials of the materials of all bodies of a case by name."""
    return {
        body.name: conduction_potential(find_material(body.material, case.materials))
        for body in case.bodies
    }
