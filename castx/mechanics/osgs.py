"""The projected pressure gradient of the orthogonal sub-grid scales (Chiumenti, 2.2)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem, la
from dolfinx.fem.petsc import assemble_matrix, create_matrix

from castx.arrays import FloatArray
from castx.domain.measures import cell_measure
from castx.domain.mesh import BodyMesh
from castx.forms import stabilisation
from castx.mechanics.fixed_directions import FixedDirections


class Projection:
    """The lumped, τ-weighted projection Π of the pressure gradient of one body (OSGS).

    On symmetry planes Π has no normal component: that of the mirror image would cancel it.

    Args:
        body: mesh of the body.
        model: geometric model.
        tau: stabilisation parameter of the cells [m²/Pa].
        pressure_scale: pressure that is one in the unknowns [Pa].
        planes: symmetry planes of the body.
    """

    def __init__(
        self,
        body: BodyMesh,
        model: str,
        tau: Any,
        pressure_scale: float,
        planes: Sequence[FixedDirections],
    ) -> None:
        mesh, nodes = body.mesh, body.nodes
        dimension: int = mesh.geometry.dim
        vectors = fem.functionspace(mesh, ("Lagrange", 1, (dimension,)))
        dx = cell_measure(body, model, 2)
        p, omega = ufl.TrialFunction(nodes), ufl.TestFunction(vectors)
        self._scale, self._dimension = pressure_scale, dimension
        self._gradient_form = fem.form(stabilisation.weighted_gradient(p, omega, tau, dx))
        self._weight_form = fem.form(
            stabilisation.projection_weight(ufl.TestFunction(nodes), tau, dx)
        )
        self._weight = la.vector(nodes.dofmap.index_map)
        self._gradient = create_matrix(self._gradient_form)
        self._pressure, self._force = (self._gradient.createVecRight() for _ in range(2))
        self._projected = self._gradient.createVecLeft()
        self._mirrored, self._in_planes = _tangential(
            planes, nodes.dofmap.index_map.size_local, dimension
        )

    def assemble(self) -> None:
        """Assemble the operator for the present shear moduli."""
        self._gradient.zeroEntries()
        assemble_matrix(self._gradient, self._gradient_form)
        self._gradient.assemble()
        self._weight.array[:] = 0
        fem.assemble_vector(self._weight.array, self._weight_form)
        self._weight.scatter_reverse(la.InsertMode.add)

    def correction(self, pressure: FloatArray) -> FloatArray:
        """Return Σ_e τ_e ∫ ∇q·Π(p) of the owned nodes, scaled like the unknown.

        Args:
            pressure: scaled pressure at the owned nodes, ghosts may follow.
        """
        owned = self._pressure.getLocalSize()
        self._pressure.array[:] = pressure[:owned]
        self._gradient.mult(self._pressure, self._projected)
        projected = self._projected.array.reshape(owned, self._dimension)
        # Nodes inside trapped liquid have no weight: nothing is projected there.
        weight = self._weight.array[:owned, None]
        np.divide(projected, weight, out=projected, where=weight > 0)
        mirrored = self._mirrored
        projected[mirrored] = np.einsum("nij,nj->ni", self._in_planes, projected[mirrored])
        self._gradient.multTranspose(self._projected, self._force)
        return self._scale**2 * self._force.array


def _tangential(
    planes: Sequence[FixedDirections], owned: int, dimension: int
) -> tuple[npt.NDArray[np.intp], FloatArray]:
    """Return the owned nodes on planes and projectors on the directions that all planes allow."""
    everywhere = np.zeros((owned, len(planes), dimension))
    for k, plane in enumerate(planes):
        everywhere[plane.nodes, k] = plane.directions
    nodes = np.flatnonzero(everywhere.any(axis=(1, 2)))
    normals = everywhere[nodes]
    return nodes, np.eye(dimension) - np.linalg.pinv(normals, rcond=1e-6) @ normals
