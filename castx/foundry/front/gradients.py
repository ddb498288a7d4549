"""Magnitude of the gradient of a nodal field, averaged over the cells round each node."""

from __future__ import annotations

from typing import TYPE_CHECKING

import basix
import numpy as np
from dolfinx import fem, la

from castx.arrays import FloatArray

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh


class Steepness:
    """Recovery of |∇f| at the nodes of a body from the gradients of its cells.

    Magnitudes are averaged, not vectors: where fronts meet the mean vector vanishes though every
    cell is steep. Elsewhere the two differ by the square of the element size.

    Args:
        body: the body; cells are evaluated at their midpoints.
    """

    def __init__(self, body: BodyMesh) -> None:
        space = body.nodes
        mesh = space.mesh
        cells = mesh.topology.index_map(mesh.topology.dim).size_local
        self.cell_nodes = space.dofmap.list[:cells]
        self._gradients, self._volumes = midpoint_gradients(
            space, space.tabulate_dof_coordinates()[self.cell_nodes, : mesh.geometry.dim]
        )
        self._sum = fem.Function(space)

    def in_cells(self, values: FloatArray) -> FloatArray:
        """Return |∇f| of a nodal field (nodes,) in the owned cells: (cells,)."""
        gradients = np.einsum("cak,ca->ck", self._gradients, values[self.cell_nodes])
        return np.asarray(np.linalg.norm(gradients, axis=1))

    def at_nodes(self, in_cells: FloatArray, weights: FloatArray) -> FloatArray:
        """Return the mean at the nodes of a field of the owned cells (cells,); collective.

        Cells count with their volumes times `weights` (cells,), and not at all where that is zero;
        a node without a cell that counts is not a number.
        """
        weights = weights * self._volumes
        counting = np.where(weights > 0.0, in_cells, 0.0)
        total = self._summed(weights)
        mean = np.full_like(total, np.nan)
        return np.divide(self._summed(weights * counting), total, out=mean, where=total > 0.0)

    def _summed(self, in_cells: FloatArray) -> FloatArray:
        """Return at each node, ghosts included, the sum over the cells round it on all ranks."""
        array = self._sum.x.array
        array[:] = 0.0
        np.add.at(array, self.cell_nodes, in_cells[:, None])
        self._sum.x.scatter_reverse(la.InsertMode.add)
        self._sum.x.scatter_forward()
        return array.copy()


def midpoint_gradients(
    space: fem.FunctionSpace, corners: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the gradients of the basis functions at the midpoints of cells, and the volumes.

    Args:
        space: a scalar linear space.
        corners: positions of the nodes of each cell, (cells, nodes, gdim).

    Returns:
        Gradients (cells, nodes, gdim) [1/m], volumes (cells,) [m^gdim].
    """
    element = space.element.basix_element
    reference = np.asarray(basix.geometry(element.cell_type))
    midpoint = reference.mean(axis=0, keepdims=True)
    slopes = element.tabulate(1, midpoint)[1:, 0, :, 0]
    jacobians = np.einsum("cai,ka->cik", corners, slopes)
    gradients = np.einsum("ka,cki->cai", slopes, np.linalg.inv(jacobians))
    size = basix.cell.volume(element.cell_type)
    return gradients, np.abs(np.linalg.det(jacobians)) * size
