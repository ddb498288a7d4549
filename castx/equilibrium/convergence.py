"""When the forces of all bodies balance well enough, and where they do so least."""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray
from castx.contact.kinematics.gaps import Gaps
from castx.equilibrium.net_forces import NetForces
from castx.mechanics.assembly import BodyAssembly
from castx.solvers.layout import Layout
from castx.solvers.worst_place import Part, worst_place

ROUNDING = 2e-14
"""Part of the terms of a row that no iteration takes away from their sum."""

MEANT_STRAIN = 1e-6
"""Strain whose rounding is a force without meaning, whatever the bodies do at present."""

STANDING, LOOSEST_ADVISED = 5, 1e-3
"""Iterates without progress that are a standstill, and a tolerance beyond which none is advised."""

BODY_SHARE = 1e-4
"""Least part of the largest internal forces of any body to which those of another are resolved."""

NET_SHARE = 1e-7
"""Part of the internal forces of a body below which net forces are not resolved."""


class ForceConvergence:
    """Convergence test: the residual of each body relative to the net forces on it.

    Net forces are loads and contact forces: hot castings weigh a millionth of their internal
    forces, which cancel. Those measure a body on which nothing else acts.

    Attributes:
        tolerance: residual relative to the net forces on a body.
        weakest: internal forces in the body with the weakest ones [N].
        acting: what the residual of each body is measured by [N], shape (bodies,).
        errors: resultant of the last tested residual on each body relative to `acting`, shape
            (bodies,).

    Args:
        assembly: the bodies.
        layout: of the rows; those behind the bodies are measured by the weakest body.
        net: forces on the bodies from outside.
        tolerance: residual relative to the net forces on a body.
    """

    def __init__(
        self, assembly: BodyAssembly, layout: Layout, net: NetForces, tolerance: float
    ) -> None:
        self._assembly, self._net, self.tolerance = assembly, net, tolerance
        self._parts = [layout.local_slice(k) for k in range(len(layout.block_sizes))]
        self._comm = layout.comm
        self._targets: FloatArray = np.zeros(len(self._parts))
        self._length = max(body.length for body in assembly.bodies)
        self._at_start: float | None = None
        self.weakest = self.rounding = self._meaningless = 0.0
        self.acting: FloatArray = np.zeros(len(assembly.bodies))
        self.errors: FloatArray = np.zeros(len(assembly.bodies))

    def begin(self, stiffness: FloatArray) -> None:
        """Start a new solution; the forces at its start stay part of the reference until its end.

        Args:
            stiffness: diagonal of the rows of displacements [N/m].
        """
        self._at_start = None
        squares = self._comm.allreduce(float(stiffness @ stiffness), op=MPI.SUM)
        self._meaningless = ROUNDING * MEANT_STRAIN * self._length * float(np.sqrt(squares))

    def update(self, x: PETSc.Vec, diagonal: FloatArray, pair_forces: FloatArray) -> None:
        """Measure the forces at the unknowns x.

        Args:
            x: the unknowns.
            diagonal: of the rows [N/m].
            pair_forces: contact forces of all pairs, zero where they are open [N].
        """
        internal = self._assembly.force_scales()
        internal = np.maximum(internal, BODY_SHARE * internal.max())
        self.weakest = float(internal.min())
        acting = self._net.acting(pair_forces)
        net = np.clip(acting, NET_SHARE * internal, internal)
        self.acting = np.where(acting > 0, net, internal)
        midsides = self.acting[self._assembly.quadratic]
        others = len(self._parts) - len(internal) - len(midsides)
        rest = np.append(midsides, np.full(others, self.acting.min()))
        # Of all rows together: linear solves mix them. Unknowns, all of them lengths, beyond the
        # size of the bodies are those of an iteration that ran away: its rows are mere rounding.
        terms = diagonal * np.minimum(np.abs(x.array_r), self._length)
        size = float(np.linalg.norm(self._norms(terms)))
        # A body set free may end without stress, but with the rounding of what it had.
        self._at_start = size if self._at_start is None else self._at_start
        self.rounding = max(ROUNDING * max(size, self._at_start), self._meaningless)
        self._targets = np.maximum(self.tolerance * np.append(self.acting, rest), self.rounding)

    def _norms(self, rows: FloatArray) -> FloatArray:
        squares = np.array([float(rows[part] @ rows[part]) for part in self._parts])
        return np.asarray(np.sqrt(self._comm.allreduce(squares, op=MPI.SUM)))

    def is_met(self, residual: PETSc.Vec) -> bool:
        """Return whether the residual of each body is small enough, and its resultant too."""
        missing = self._net.missing(residual.array_r)
        scale = np.maximum(self.acting, self.rounding / self.tolerance)
        self.errors = np.divide(missing, scale, out=np.zeros_like(missing), where=scale > 0)
        small = self._norms(residual.array_r) <= self._targets
        return bool(np.all(small) and np.all(self.errors <= self.tolerance))

    @property
    def smallest(self) -> float:
        """Residual that is small enough for every body [N]."""
        return float(self._targets.min())


def standstill(residuals: Sequence[float], wanted: float, tolerance: float) -> str:
    """Return advice for a residual that stands still just above its limit, or nothing.

    Rounding keeps it there, not the forces.

    Args:
        residuals: of the iterates [N].
        wanted: residual that would do [N].
        tolerance: to which it belongs.
    """
    last = np.array(residuals[-STANDING:])
    if len(residuals) < 2 * STANDING or not np.isfinite(last).all() or wanted <= 0.0:
        return ""
    if last.min() < 0.5 * min(residuals[:-STANDING]):
        return ""
    enough = 10.0 ** np.ceil(np.log10(tolerance * last.max() / wanted))
    if enough > LOOSEST_ADVISED:
        return ""
    return (
        f"; the residual stands still between {last.min():.2g} and {last.max():.2g} N and has to "
        f"fall below {wanted:.2g} N, which rounding does not allow here: solver."
        f"mechanics_tolerance = {enough:.0e} accepts it"
    )


def worst_row(assembly: BodyAssembly, gaps: Gaps, layout: Layout, f: PETSc.Vec) -> str:
    """Return the place of the largest residual as a text, the same on all ranks; collective.

    Args:
        assembly: the bodies.
        gaps: the pairs of all interfaces.
        layout: of the rows.
        f: the residual.
    """
    parts = []
    for b, body in enumerate(assembly.bodies):
        own = f.array_r[layout.local_slice(b)].reshape(-1, body.block_size)
        points, d = body.mesh.points[: len(own)], body.dimension
        parts.append(Part(f"body {body.name!r} (forces)", own[:, :d], points))
        parts.append(Part(f"body {body.name!r} (volumes, axial strain)", own[:, d:], points))
    rest = f.array_r[assembly.layout.size_local :]
    for part, interface in zip(gaps.slices, gaps.interfaces, strict=True):
        if len(rest):
            points = interface.pairs.points[interface.index]
            parts.append(Part(f"interface {interface.pairs.name!r}", rest[part], points))
    return worst_place(layout.comm, parts, "N")
