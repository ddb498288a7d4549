"""Limit of free motions in one Newton step: the first contact.

Weak springs let a body that has lost its contact swing by metres before they balance its weight,
and the end of a casting swings as far about a neck of mush. Everything on the way would then close
at once and be pressed together, which a law that flows cannot follow. So the motion ends where the
first open pair closes, and the next step finds what this pair bears: the ratio test of active-set
methods (J. Nocedal and S. J. Wright, Numerical Optimization, 2nd ed., section 16.5).
"""

from __future__ import annotations

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.kinematics.iterate import PairIterate
from castx.contact.system import ContactSystem
from castx.equilibrium.supports.springs import SpringSupport

ROUNDING = 4.0 * float(np.finfo(np.float64).eps)
"""Part of a step by which its entries are rounded: a pair must end behind the
contact, since in front of it it would never close. Pairs with a pair law need no such depth; by it
they would carry more than the tolerance."""

OVERLAP = 5e-5
"""Penetration of open pairs in a step of metal that flows, over the length of the smallest body:
some micrometres, by which a cell of the skin is pressed to its yield stress or less. A shaft of
140 mm that leaves its die takes 277, 274 and 498 iterations with 1.4e-5, 5e-5 and 2e-4, and 756
without."""


class FirstContact:
    """Ends motions at the first contact.

    Args:
        contact: the contact method.
        unknowns: a vector of the displacements and pressures of all bodies, to copy its layout.
    """

    def __init__(self, contact: ContactSystem, unknowns: PETSc.Vec) -> None:
        self._contact, self._unknowns = contact, unknowns

    def stop(
        self, support: SpringSupport, x: PETSc.Vec, y: PETSc.Vec,
        open_pairs: BoolArray, force: float, stiffness: float,
    ) -> bool:  # fmt: skip
        """Shorten the rigid part of a step to x − y; return whether it has changed; collective.

        Args:
            support: springs on the motions that nothing else holds.
            x: unknowns at which the step starts.
            y: the step.
            open_pairs: those that close when they penetrate, shape (pairs,).
            force: by which they do [N].
            stiffness: of the contact method where it has none of its own [N/m].
        """
        rigid = support.amplitudes(y.array_r) @ support.motions
        start, end = (self._gaps(x, step) for step in (y.array_r - rigid, y.array_r))
        depth = self._depth(x, len(start), force, stiffness)
        if not self._contact.normal.follows_set:
            largest = support.comm.allreduce(float(np.abs(y.array_r).max(initial=0.0)), op=MPI.MAX)
            depth = np.maximum(depth, ROUNDING * largest)
        share = share_until_contact(support.comm, start, end, open_pairs, depth)
        if share < 1.0:
            y.array[:] -= (1.0 - share) * rigid
        return share < 1.0

    def stop_overlap(self, x: PETSc.Vec, y: PETSc.Vec, open_pairs: BoolArray, depth: float) -> bool:
        """Shorten a step to x − y that takes open pairs through each other; collective.

        Pairs that overlap at its start may do so by this much more, so that no step ends at once.

        Args:
            x: unknowns at which the step starts.
            y: the step.
            open_pairs: those that close when they penetrate, shape (pairs,).
            depth: penetration at which it ends [m].

        Returns:
            Whether it has changed.
        """
        start, end = (self._gaps(x, step) for step in (np.zeros_like(y.array_r), y.array_r))
        ahead = np.maximum(start, 0.0)
        comm = x.getComm().tompi4py()
        depths = np.full(len(start), depth)
        share = share_until_contact(comm, ahead, ahead + end - start, open_pairs, depths)
        if share < 1.0:
            y.scale(share)
        return share < 1.0

    def _gaps(self, x: PETSc.Vec, step: FloatArray) -> FloatArray:
        place, unknowns = x.duplicate(), self._unknowns.duplicate()
        place.array[:] = x.array_r - step
        self._contact.unknowns.displacements(place, unknowns)
        gaps = self._contact.normal.gaps(place, unknowns)
        for vector in (place, unknowns):
            vector.destroy()
        return gaps

    def _depth(self, x: PETSc.Vec, pairs: int, force: float, stiffness: float) -> FloatArray:
        """Return the penetrations that give open pairs a force [m]."""
        rows, closed = np.zeros(x.getLocalSize()), np.zeros(pairs, dtype=bool)
        apart, through = (
            self._contact.normal.trial_forces(
                PairIterate(x, rows, np.full(pairs, gap), closed, stiffness)
            )
            for gap in (0.0, -1.0)
        )
        resistance = through - apart
        ratios = np.full(pairs, np.inf)
        np.divide(force, resistance, out=ratios, where=resistance > 0)
        return ratios


def share_until_contact(
    comm: MPI.Intracomm, start: FloatArray, end: FloatArray, may_close: BoolArray, depth: FloatArray
) -> float:
    """Return the share of a motion at which the first pair reaches its depth, at most 1.

    Args:
        comm: ranks of the pairs.
        start: gaps before the motion [m], shape (pairs,).
        end: gaps behind all of it [m], shape (pairs,).
        may_close: open pairs that close when they penetrate, shape (pairs,).
        depth: penetration at which they do [m], shape (pairs,).
    """
    change = end - start
    hits = may_close & (change < 0) & (end < -depth)
    shares = (start + depth)[hits] / -change[hits]
    return float(comm.allreduce(max(0.0, float(shares.min(initial=1.0))), op=MPI.MIN))
