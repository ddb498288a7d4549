"""Errors of values in cells, by the values recovered at the nodes.

The error of values that are constant in each cell is estimated by their difference from linear ones
that are recovered from them: O. C. Zienkiewicz, J. Z. Zhu, A simple error estimator and adaptive
procedure for practical engineering analysis, International Journal for Numerical Methods in
Engineering 24 (1987) 337, here in the L2 norm.
"""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
from dolfinx import la

from castx.arrays import BoolArray, FloatArray
from castx.discretisation.recovery import PatchRecovery
from castx.domain.mesh import BodyMesh

SYMMETRIC = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
"""How often xx, yy, zz, xy, xz, yz stand in a symmetric tensor."""


class CellErrors:
    """Errors of the values in the cells of a body.

    Args:
        body: its mesh.
        model: geometric model.
        counting: whether each local cell counts, (cells,); None: all do.

    Attributes:
        recovery: of the values at the nodes.
        volumes: of the owned cells, of those that do not count zero, (owned cells,) [m³].
    """

    def __init__(
        self, body: BodyMesh, model: str, counting: BoolArray | None = None
    ) -> None:
        self._body = body
        self.recovery = PatchRecovery(body, counting)
        places, weights = body.kind.quadrature(2)
        self._shapes = body.kind.shape_functions(places)[0]
        corners = body.points[self.recovery.cell_nodes]
        jacobians = body.kind.jacobians(corners, places)
        self._weights = np.abs(np.linalg.det(jacobians)) * weights
        if model == "axisymmetric":
            self._weights *= 2.0 * np.pi * corners[:, :, 0] @ self._shapes.T
        self._weights *= self.recovery.counting[:, None]
        self.volumes: FloatArray = self._weights.sum(axis=1)

    def of(self, values: FloatArray) -> FloatArray:
        """Return the root mean square of the error in each local cell, (cells,); collective.

        It is zero in cells that do not count.

        Args:
            values: in the local cells, (cells, components); six are a symmetric tensor.
        """
        nodes = self.recovery.cell_nodes
        recovered = self.recovery.at_nodes(values)[nodes]
        at_points = np.einsum("pa,cak->cpk", self._shapes, recovered)
        difference = at_points - values[: len(nodes), None]
        squares = np.einsum("cpk,k->cp", difference**2, often(values))
        sums = np.einsum("cp,cp->c", squares, self._weights)
        volumes = np.where(self.volumes > 0.0, self.volumes, 1.0)
        return self._with_ghosts(np.sqrt(sums / volumes))

    def _with_ghosts(self, own: FloatArray) -> FloatArray:
        cells = la.vector(self._body.mesh.topology.index_map(self._body.mesh.topology.dim))
        cells.array[: len(own)] = own
        cells.scatter_forward()
        return np.asarray(cells.array.copy())

    def described(self, values: FloatArray) -> dict[str, float] | None:
        """Return the error over the whole body for run.json; None: no cell counts; collective.

        Args:
            values: in the local cells, (cells, components).

        Returns:
            Root mean squares over the volume of error and values, and the error relative to what
            is recovered.
        """
        errors = self.of(values)[: len(self.volumes)]
        squares = squared(values)[: len(self.volumes)]
        local = [self.volumes @ errors**2, self.volumes @ squares, self.volumes.sum()]
        return described_error(self._body.mesh.comm.allreduce(np.array(local), op=MPI.SUM))


def often(values: FloatArray) -> FloatArray:
    """Return the weights of components in the square of values, (components,)."""
    return SYMMETRIC if values.shape[1] == len(SYMMETRIC) else np.ones(values.shape[1])


def squared(values: FloatArray) -> FloatArray:
    """Return the squares of vectors or symmetric tensors, (cells,)."""
    return np.asarray(values**2 @ often(values))


def described_error(sums: FloatArray) -> dict[str, float] | None:
    """Return root mean squares and relative error from sums over all ranks; None without any.

    Args:
        sums: of squared errors, of squared values and of weights, (3,).
    """
    if sums[2] <= 0.0:
        return None
    error, size = (float(x) for x in np.sqrt(sums[:2] / sums[2]))
    whole = float(np.hypot(error, size))
    return {"error": error, "size": size, "relative": error / whole if whole > 0.0 else 0.0}
