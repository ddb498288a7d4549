"""Net forces on each body: external forces, and the error of their balance.

Internal forces cancel each other. Those of a casting that is hindered in its contraction are
thousands of times its weight, so that an error that is small beside them may be all of a contact
force.
"""

from __future__ import annotations

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.contact.kinematics.gaps import Gaps
from castx.contact.kinematics.transform import ConstraintTransform
from castx.mechanics.assembly import BodyAssembly
from castx.mechanics.body import BodyMechanics


class NetForces:
    """Forces on the bodies of one layout.

    Args:
        assembly: the bodies.
        transform: change of unknowns of all bodies.
        gaps: the pairs of all interfaces.
    """

    def __init__(
        self, assembly: BodyAssembly, transform: ConstraintTransform, gaps: Gaps
    ) -> None:
        self._assembly, self._transform, self._gaps = assembly, transform, gaps
        self._comm = assembly.layout.comm
        self._pairs = gaps.matrix.createVecLeft()
        self._nodes = gaps.matrix.createVecRight()

    def acting(self, pair_forces: FloatArray) -> FloatArray:
        """Return the reference force of each body [N], shape (bodies,); collective.

        It is the sum of the magnitudes of the loads on its nodes, such as its weight, and of a body
        without loads that of the contact forces, among which the springs of machines count. Of both
        it is not the larger one: walls that squeeze a casting cancel like internal forces, and its
        weight still has to reach the floor.

        Args:
            pair_forces: contact forces of all rows, zero where they are open [N], shape (rows,).
        """
        self._pairs.array[:] = pair_forces
        self._gaps.matrix.multTranspose(self._pairs, self._nodes)
        contact = self._nodes.array_r
        layout = self._assembly.layout
        sums = np.zeros((len(self._assembly.bodies), 2))
        for b, body in enumerate(self._assembly.bodies):
            forms = body.formulation.forms
            touching = contact[layout.local_slice(b)], forms.spring_forces()
            sums[b] = _magnitudes(body, forms.load), sum(_magnitudes(body, f) for f in touching)
        loads, contacts = self._comm.allreduce(sums, op=MPI.SUM).T
        return np.where(loads > 0, loads, contacts)

    def missing(self, rows: FloatArray) -> FloatArray:
        """Return the magnitude of the resultant of a residual on each body [N], shape (bodies,).

        Of an axisymmetric body it is the resultant along the axis. Collective.

        Args:
            rows: owned residual, conjugate to the unknowns of a contact method [N].
        """
        layout = self._assembly.layout
        nodal = self._transform.forces_on_nodes(rows[: layout.size_local])
        sums = np.zeros((len(self._assembly.bodies), 3))
        for b, body in enumerate(self._assembly.bodies):
            own = nodal[layout.local_slice(b)].reshape(-1, body.block_size)
            first = 1 if body.model == "axisymmetric" else 0
            resultant = own[:, first : body.dimension].sum(axis=0)
            sums[b, : len(resultant)] = resultant
        return np.asarray(np.linalg.norm(self._comm.allreduce(sums, op=MPI.SUM), axis=1))

    def destroy(self) -> None:
        """Free the vectors."""
        self._pairs.destroy()
        self._nodes.destroy()


def _magnitudes(body: BodyMechanics, forces: FloatArray) -> float:
    """Return the sum of the magnitudes of owned nodal forces on a body [N]."""
    nodal = forces.reshape(-1, body.block_size)[:, : body.dimension]
    return float(np.linalg.norm(nodal, axis=1).sum())
