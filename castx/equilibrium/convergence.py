"""When the forces of all bodies balance well enough, and where they do so least."""

from __future__ import annotations

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray
from castx.contact.kinematics.gaps import Gaps
from castx.mechanics.assembly import BodyAssembly
from castx.solvers.layout import Layout
from castx.solvers.worst_place import Part, worst_place

ROUNDING = 2e-14
"""Part of the terms of a row that no iteration takes away from their sum."""

BODY_SHARE = 1e-4
"""Least part of the largest forces of any body to which those of another are resolved."""


class ForceConvergence:
    """Convergence test: the residual of each body relative to its internal forces.

    Each body is measured by its own forces: a soft hot casting would have none of its own beside
    those of a stiff mould.

    Attributes:
        tolerance: residual relative to the largest internal, contact or external force.
        weakest: forces in the body with the weakest ones [N].

    Args:
        assembly: the bodies.
        layout: of the rows; those behind the bodies are measured by the weakest body.
        tolerance: residual relative to the largest internal, contact or external force.
    """

    def __init__(self, assembly: BodyAssembly, layout: Layout, tolerance: float) -> None:
        self._assembly, self.tolerance = assembly, tolerance
        self._parts = [layout.local_slice(k) for k in range(len(layout.block_sizes))]
        self._comm = layout.comm
        self._targets: FloatArray = np.zeros(len(self._parts))
        self._length = max(body.length for body in assembly.bodies)
        self._at_start: float | None = None
        self.weakest = 0.0

    def begin(self) -> None:
        """Start a new solution: what acts at its start counts to its end."""
        self._at_start = None

    def update(self, x: PETSc.Vec, diagonal: FloatArray) -> None:
        """Measure the forces at the unknowns x, rows with this diagonal."""
        forces = self._assembly.force_scales()
        forces = np.maximum(forces, BODY_SHARE * forces.max())
        self.weakest = float(forces.min())
        rest = np.full(len(self._parts) - len(forces), self.weakest)
        # Of all rows together: linear solves mix them. Unknowns, all of them lengths, beyond the
        # size of the bodies are those of an iteration that ran away: its rows are mere rounding.
        terms = diagonal * np.minimum(np.abs(x.array_r), self._length)
        size = float(np.linalg.norm(self._norms(terms)))
        # A body set free may end without stress, but with the rounding of what it had.
        self._at_start = size if self._at_start is None else self._at_start
        rounding = ROUNDING * max(size, self._at_start)
        self._targets = np.maximum(self.tolerance * np.append(forces, rest), rounding)

    def _norms(self, rows: FloatArray) -> FloatArray:
        squares = np.array([float(rows[part] @ rows[part]) for part in self._parts])
        return np.asarray(np.sqrt(self._comm.allreduce(squares, op=MPI.SUM)))

    def is_met(self, residual: PETSc.Vec) -> bool:
        """Return whether the residual of each body is small enough."""
        return bool(np.all(self._norms(residual.array_r) <= self._targets))

    @property
    def smallest(self) -> float:
        """Residual that is small enough for every body [N]."""
        return float(self._targets.min())


def worst_row(assembly: BodyAssembly, gaps: Gaps, layout: Layout, f: PETSc.Vec) -> str:
    """Say where a residual is largest, the same text on all ranks; collective.

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
