"""Interfaces whose heat depends on the solid fraction of a whole body, in Newton's method.

Every node of such a body acts on every pair, which would fill the Jacobian. It is J + U Vᵀ instead,
with one column of U = ∂F/∂F_S and V = ∂F_S/∂x for each interface, and the step of J is corrected by
the formula of J. Sherman, W. J. Morrison and M. A. Woodbury (1950).
"""

from __future__ import annotations

from collections.abc import Sequence

from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray
from castx.heat.body import ThermalBody
from castx.heat.interface import PairExchange
from castx.solvers.layout import Layout


class SolidFeedback:
    """Mean solid fractions of the bodies that interfaces ask for, and their derivatives.

    Args:
        layout: numbering of the nodes of all bodies.
        bodies: in the order of the layout.
        exchanges: interfaces under a law.
    """

    def __init__(
        self, layout: Layout, bodies: Sequence[ThermalBody], exchanges: Sequence[PairExchange]
    ) -> None:
        self._layout, self._bodies = layout, bodies
        self.exchanges = [e for e in exchanges if e.law.needs_solid_fraction]
        self._asked = sorted({exchange.secondary for exchange in self.exchanges})
        local = np.array([body.volumes.sum() for body in bodies])
        self._totals = self._sums(local) if self._asked else local

    def _sums(self, values: FloatArray) -> FloatArray:
        return np.asarray(sum(self._layout.comm.allgather(values)))

    def means(self) -> FloatArray:
        """Return the mean solid fraction of each body; zero where no law asks for it."""
        means = np.zeros(len(self._bodies))
        if self._asked:
            for k in self._asked:
                body = self._bodies[k]
                means[k] = body.volumes @ body.solid_fraction.x.array[: body.owned]
            means = self._sums(means) / self._totals
        return means

    def mean_slope(
        self, exchange: PairExchange, enthalpy_slope: PETSc.Vec, slope: PETSc.Vec
    ) -> None:
        """Fill the derivative of the solid fraction that an interface asks for over all unknowns.

        Args:
            exchange: the interface.
            enthalpy_slope: of the nodes over their unknown.
            slope: receives the derivative, node by node [m³/J].
        """
        k = exchange.secondary
        body, part = self._bodies[k], self._layout.local_slice(k)
        curve = body.curve.solid_fraction_slope(body.enthalpy.x.array[: body.owned])
        slope.array[:] = 0.0
        slope.array[part] = body.volumes / self._totals[k] * curve * enthalpy_slope.array_r[part]


def couple_step(
    columns: Sequence[tuple[PETSc.Vec, PETSc.Vec]], y: PETSc.Vec, solver: PETSc.KSP
) -> None:
    """Turn the solution of J y = F into that of (J + U Vᵀ) y = F.

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
