"""Extremes of the stress in a body: principal values and von Mises, with their places."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mpi4py import MPI

import numpy as np
import ufl
from dolfinx import fem

from castx.arrays import FloatArray
from castx.domain.measures import cell_measure
from castx.foundry.cracking import principal_values
from castx.foundry.stress.extremes import largest, quantile, smallest

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh


HIGH = 0.99
"""Share of the volume below a high stress: the cells at a sharp corner are less than the rest."""


class StressExtremes:
    """Finds the extremes of the stress in the cells of a body.

    Args:
        body: its mesh.
        model: geometric model.
    """

    def __init__(self, body: BodyMesh, model: str) -> None:
        self._comm = body.mesh.comm
        space = fem.functionspace(body.mesh, ("DG", 0))
        owned = space.dofmap.index_map.size_local
        form = fem.form(ufl.TestFunction(space) * cell_measure(body, model, 2))
        self._volumes = fem.assemble_vector(form).array[:owned]
        self._numbers = body.original_cells[:owned]
        self._middles = body.points[body.nodes.dofmap.list[:owned]].mean(axis=1)

    def of(self, stress: FloatArray) -> dict[str, Any]:
        """Return the extremes as JSON knows them; collective.

        Args:
            stress: of the owned cells as xx yy zz xy xz yz, (cells, 6) [Pa].

        Returns:
            Largest and smallest principal stress and largest von Mises stress, each with the middle
            of its cell; the mean of the latter over the volume, and what 99 % of the volume do not
            exceed of the first and the last.
        """
        principal = principal_values(stress)
        von_mises = np.sqrt(0.5 * np.sum((principal - np.roll(principal, 1, axis=1)) ** 2, axis=1))
        sums = np.array([self._volumes @ von_mises, self._volumes.sum()])
        self._comm.Allreduce(MPI.IN_PLACE, sums, op=MPI.SUM)
        where = self._numbers, self._middles
        return {
            "largest_principal": largest(self._comm, principal[:, 0], *where),
            "smallest_principal": smallest(self._comm, principal[:, 2], *where),
            "von_mises": largest(self._comm, von_mises, *where),
            "mean_von_mises": float(sums[0] / sums[1]),
            "high_principal": quantile(self._comm, principal[:, 0], self._volumes, HIGH),
            "high_von_mises": quantile(self._comm, von_mises, self._volumes, HIGH),
        }
