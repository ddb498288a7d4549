"""Weak support of the rigid motions that neither displacement conditions nor closed pairs fix.

The springs act on these motions only, so that a body which stands on a floor and can slide is held
sideways and its weight still goes to the floor. In the linear solve they are exact: the resultant
of the load is taken out (spread over the body like its volume), the rest solved with as many pinned
entries as there are motions, which is statically determinate, and the springs put the motion back.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.equilibrium.supports.falling import CONSTRAINED, BodiesTogether, completed

TIE = 1e-6
"""Relative difference below which two entries fix a motion equally well."""

WEAK, FIRM = 1e-7, 1.0
"""Stiffness of the springs per volume, in units of G/L²: where a body may still come into
contact, and where nothing is left for it to fall onto."""


@dataclass(frozen=True)
class SpringSupport:
    """Springs on floating motions; all arrays hold the owned part of a vector of unknowns.

    Attributes:
        motions: rigid motions Z in the unknowns, shape (motions, owned).
        weights: W with WᵀZ = 1: amplitudes of the motions are Wᵀx, shape (motions, owned).
        pins: owned entries that fix the motions, no more.
        stiffness: force per amplitude of each motion [N/m], shape (motions,).
        comm: communicator of the unknowns.
    """

    motions: FloatArray
    weights: FloatArray
    pins: LongArray
    stiffness: FloatArray
    comm: MPI.Intracomm

    def amplitudes(self, x: FloatArray) -> FloatArray:
        """Return the amplitudes Wᵀx of the motions in an owned part x."""
        return np.asarray(self.comm.allreduce(self.weights @ x, op=MPI.SUM))

    def resultants(self, r: FloatArray) -> FloatArray:
        """Return the components Zᵀr of an owned part r of a force."""
        return np.asarray(self.comm.allreduce(self.motions @ r, op=MPI.SUM))

    def force(self, x: FloatArray) -> FloatArray:
        """Return the owned part of the spring forces at x."""
        return np.asarray((self.stiffness * self.amplitudes(x)) @ self.weights)

    def resultant(self, x: FloatArray) -> float:
        """Return the norm of the spring forces on the motions at x [N]."""
        return float(np.linalg.norm(self.stiffness * self.amplitudes(x)))


class FloatingMotions:
    """Finds the rigid motions of all bodies that a set of constraints leaves free.

    Args:
        motions: rigid motions of all bodies in the unknowns, shape (motions, owned).
        weights: their images under the volume matrix: Mz for the motion z.
        stiffness: of the springs per volume [Pa/m²].
        comm: communicator of the unknowns.
        held: how far each motion strains other springs of this rank, which hold it like a
            constraint, shape (motions, springs); None: there are no others.
        together: bodies joined by contact, of which those that fall without end are on springs of
            the stiffness that bodies without any contact have.
    """

    def __init__(
        self,
        motions: FloatArray,
        weights: FloatArray,
        stiffness: float,
        comm: MPI.Intracomm,
        held: FloatArray | None = None,
        together: Sequence[BodiesTogether] = (),
    ) -> None:
        self._together = tuple(together)
        self.motions, self._comm = motions, comm
        self._held = np.zeros((len(motions), 0)) if held is None else held
        # Springs see the mean motion: a volume-weighted inner product that integrates to one.
        volume = comm.allreduce(float(np.sum(motions[0] * weights[0])))
        self._stiffness = stiffness * volume
        self._weights = weights / volume

    def find(
        self, constrained: BoolArray, constraint_values: FloatArray | None = None
    ) -> SpringSupport | None:
        """Return springs on the motions that nothing fixes, None if there are none.

        Args:
            constrained: owned unknowns with a Dirichlet condition.
            constraint_values: values of further constraint rows of this rank for each motion,
                shape (motions, rows).
        """
        rows = np.concatenate((self.motions[:, constrained], self._held), axis=1)
        if constraint_values is not None:
            rows = np.concatenate((rows, constraint_values), axis=1)
        gram = self._comm.allreduce(rows @ rows.T, op=MPI.SUM)
        values, vectors = np.linalg.eigh(gram)
        free = vectors[:, values < CONSTRAINED].T
        if len(free) == 0:
            return None
        falling, density = self._falling(gram)
        free = completed(falling, free)
        motions = free @ self.motions
        motions[:, constrained] = 0.0
        weights = (free * density) @ self._weights
        inner = self._comm.allreduce(weights @ motions.T, op=MPI.SUM)
        root = np.linalg.inv(np.linalg.cholesky(inner))
        motions, weights = root @ motions, root @ weights
        stiffness = np.full(len(free), self._stiffness)
        stiffness[: len(falling)] *= FIRM / WEAK
        return SpringSupport(motions, weights, self._pins(motions), stiffness, self._comm)

    def _falling(self, gram: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the motions in which bodies fall together, and by how much each weighs more."""
        falling: FloatArray = np.zeros((0, len(gram)))
        density: FloatArray = np.ones(len(gram))
        for bodies in self._together:
            for motions, denser in bodies.falling(gram):
                falling, density = np.concatenate([falling, motions]), density * denser
        return falling, density

    def _pins(self, motions: FloatArray) -> LongArray:
        """Return owned entries that together fix all motions, by pivoting on the largest.

        Of nearly equal ones the first is taken, so that neither round-off nor the basis of the
        motions decides and the entries stay from solve to solve.
        """
        columns, pins = motions.copy(), []
        for _ in range(len(motions)):
            sizes = np.linalg.norm(columns, axis=0)
            largest = self._comm.allreduce(float(sizes.max(initial=0.0)), op=MPI.MAX)
            near = np.flatnonzero(sizes > (1 - TIE) * largest)
            rank = self._comm.allreduce(
                self._comm.rank if len(near) else self._comm.size, op=MPI.MIN
            )
            here = rank == self._comm.rank
            direction = self._comm.bcast(
                columns[:, near[0]] / sizes[near[0]] if here else None, root=rank
            )
            if here:
                pins.append(near[0])
            columns -= np.outer(direction, direction @ columns)
        return np.array(pins, dtype=np.intp)
