"""Force and moment that supports exert on each body."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.contact.kinematics.transform import ConstraintTransform
from castx.domain.measures import nodal_volumes
from castx.mechanics.body import BodyMechanics


class Resultant(NamedTuple):
    """Resultant of forces on a body.

    Attributes:
        force: [N], one number for each direction.
        moment: about the centre of its volume [N m]: three numbers in space, one in the plane, none
            in an axisymmetric model.
    """

    force: FloatArray
    moment: FloatArray


class NodalResultants:
    """Adds up forces on the unknowns of the bodies.

    Args:
        transform: change of unknowns of all bodies.
        bodies: in the order of the layout.
    """

    def __init__(self, transform: ConstraintTransform, bodies: Sequence[BodyMechanics]) -> None:
        self._transform, self._bodies = transform, list(bodies)
        self._comm = transform.layout.comm
        self._arms = [self._arm(body) for body in bodies]

    def _arm(self, body: BodyMechanics) -> FloatArray:
        volumes = nodal_volumes(body.mesh, body.model)
        points = body.mesh.points[: len(volumes)]
        sums = self._comm.allreduce(
            np.concatenate((volumes @ points, [volumes.sum()])), op=MPI.SUM
        )
        return np.asarray(points - sums[:-1] / sums[-1])

    def of(self, forces: FloatArray) -> dict[str, Resultant]:
        """Return the resultants by name of the body; collective.

        Args:
            forces: conjugate to the unknowns v, owned part [N].
        """
        layout, nodal = self._transform.layout, self._transform.forces_on_nodes(forces)
        found = {}
        for b, body in enumerate(self._bodies):
            own = nodal[layout.local_slice(b)].reshape(-1, body.block_size)
            acting = own[:, : body.dimension]
            force, moment = acting.sum(axis=0), self._moment(body, acting, self._arms[b])
            both = self._comm.allreduce(np.concatenate((force, moment)), op=MPI.SUM)
            found[body.name] = Resultant(both[: len(force)], both[len(force) :])
        return found

    def _moment(self, body: BodyMechanics, forces: FloatArray, arms: FloatArray) -> FloatArray:
        if body.model == "axisymmetric":
            return np.zeros(0)
        if body.dimension == 2:
            return np.array([np.sum(arms[:, 0] * forces[:, 1] - arms[:, 1] * forces[:, 0])])
        return np.asarray(np.cross(arms, forces).sum(axis=0), dtype=np.float64)
