"""Solid fractions of whole bodies on which laws of interfaces depend, and their derivatives.

With a law over the solid fraction of a whole body every node of it acts on every pair, which would
fill the Jacobian. It is J + U Vᵀ instead, with a column of U = ∂F/∂F_S and of V = ∂F_S/∂x for each
such interface, and the Newton step of J is corrected.
Source: J. Sherman, W. J. Morrison and M. A. Woodbury (1950).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray
from castx.heat.body import ThermalBody
from castx.solvers.layout import Layout


class SolidFeedback:
    """Mean solid fractions F_S = (1/V) ∫ f_s dV of bodies on which laws depend, and derivatives.

    Args:
        layout: numbering of the nodes of all bodies.
        bodies: in the order of the layout.
        asked: numbers of the bodies on which laws depend.
    """

    def __init__(
        self, layout: Layout, bodies: Sequence[ThermalBody], asked: Collection[int]
    ) -> None:
        self._layout, self._bodies, self._asked = layout, bodies, sorted(asked)
        local = np.array([body.volumes.sum() for body in bodies])
        self._totals = self._sums(local) if self._asked else local

    def _sums(self, values: FloatArray) -> FloatArray:
        return np.asarray(sum(self._layout.comm.allgather(values)))

    def means(self) -> FloatArray:
        """Return the mean solid fraction of each body; zero where no law depends on it."""
        means = np.zeros(len(self._bodies))
        if self._asked:
            for k in self._asked:
                body = self._bodies[k]
                means[k] = body.volumes @ body.solid_fraction.x.array[: body.owned]
            means = self._sums(means) / self._totals
        return means

    def mean_slope(self, k: int, enthalpy_slope: PETSc.Vec, slope: PETSc.Vec) -> None:
        """Fill the derivative of the mean solid fraction of a body over all unknowns.

        Args:
            k: number of the body.
            enthalpy_slope: of the nodes over their unknown.
            slope: receives the derivative, node by node [m³/J].
        """
        body, part = self._bodies[k], self._layout.local_slice(k)
        curve = body.curve.solid_fraction_slope(body.enthalpy.x.array[: body.owned])
        slope.array[:] = 0.0
        slope.array[part] = body.volumes / self._totals[k] * curve * enthalpy_slope.array_r[part]


def couple_step(
    columns: Sequence[tuple[PETSc.Vec, PETSc.Vec]], y: PETSc.Vec, solver: PETSc.KSP
) -> None:
    """Correct a solution of J y = F to a solution of (J + U Vᵀ) y = F.

    y ← y − Z (1 + Vᵀ Z)⁻¹ Vᵀ y with J Z = U (Woodbury 1950).

    Args:
        columns: of U and V.
        y: the solution.
        solver: solves with J.
    """
    count = len(columns)
    solved = [y.duplicate() for _ in range(count)]
    for (u, _), z in zip(columns, solved, strict=True):
        solver.solve(u, z)
    matrix = np.eye(count)
    matrix += [[v.dot(z) for z in solved] for _, v in columns]
    parts = np.linalg.solve(matrix, [v.dot(y) for _, v in columns])
    for part, z in zip(parts, solved, strict=True):
        y.axpy(-float(part), z)
        z.destroy()
