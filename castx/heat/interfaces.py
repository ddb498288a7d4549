"""All interfaces of a heat problem: their exchange, and solid fractions on which it depends.

With a law over the solid fraction of a whole body every node of it acts on every pair, which would
fill the Jacobian. It is J + U Vᵀ instead, with a column of U = ∂F/∂F_S and of V = ∂F_S/∂x for each
such interface, and the Newton step of J is corrected.
Source: J. Sherman, W. J. Morrison and M. A. Woodbury (1950).
"""

from __future__ import annotations

from collections.abc import Sequence

from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray
from castx.heat.body import ThermalBody
from castx.heat.interface import MECHANISMS, HeatExchange, PairExchange
from castx.solvers.layout import Layout
from castx.transfer.pair_state import PairState


class SolidFeedback:
    """Mean solid fractions F_S = (1/V) ∫ f_s dV of bodies on which laws depend, and derivatives.

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
        """Return the mean solid fraction of each body; zero where no law depends on it."""
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
        """Fill the derivative of the solid fraction of an interface over all unknowns.

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


class Exchanges:
    """Exchange of heat at all interfaces; interfaces without a law are insulated.

    Args:
        layout: numbering of the nodes of all bodies.
        vector: any vector of the layout.
        bodies: in the order of the layout.
        descriptions: of the interfaces.
    """

    def __init__(
        self,
        layout: Layout,
        vector: PETSc.Vec,
        bodies: Sequence[ThermalBody],
        descriptions: Sequence[HeatExchange],
    ) -> None:
        names = [body.name for body in bodies]
        self._kinds = [description.kind for description in descriptions]
        self._all: list[PairExchange | None] = [
            PairExchange(
                layout,
                vector,
                names.index(description.pairs.secondary),
                names.index(description.pairs.primary),
                description,
            )
            if description.kind == "law"
            else None
            for description in descriptions
        ]
        self.under_law = [exchange for exchange in self._all if exchange is not None]
        self.feedback = SolidFeedback(layout, bodies, self.under_law)

    def set_states(
        self,
        states: Sequence[tuple[PairState, PairState] | None],
        part: float,
        factors: Sequence[FloatArray] | None = None,
    ) -> None:
        """Set the states of all pairs.

        Args:
            states: at start and end of the step for each interface; None where it has no law.
            part: of the step that has passed, between 0 and 1.
            factors: multiply the resistances 1/h at the end of each interface; None: one.
        """
        scaling = [None] * len(self._all) if factors is None else factors
        for exchange, values, factor in zip(self._all, states, scaling, strict=True):
            if exchange is not None and values is not None:
                exchange.set_states(*values, part, factor)

    def update_faces(self, temperature: PETSc.Vec, time: float) -> None:
        """Update the surfaces at a time [s]; temperatures in the layout [°C]."""
        means = self.feedback.means()
        for exchange in self.under_law:
            exchange.update_faces(temperature, float(means[exchange.secondary]), time)

    def coefficients(self, states: Sequence[PairState]) -> list[FloatArray]:
        """Return h of pairs in these states at the present temperatures [W/m²/K].

        It is infinite in perfect contact and zero where no heat crosses.
        """
        fixed = {"perfect": np.inf, "none": 0.0}
        return [
            np.full(len(state.gap), fixed[kind])
            if exchange is None
            else exchange.coefficient(state)
            for exchange, kind, state in zip(self._all, self._kinds, states, strict=True)
        ]

    def add_heat(self, balance: PETSc.Vec) -> float:
        """Add the heat that leaves the nodes to their balance; return the sum of amounts [W]."""
        through = 0.0
        for exchange in self.under_law:
            heat = exchange.heat().sum(axis=0)
            exchange.add_heat(heat, balance)
            through += np.abs(heat).sum()
        return float(through)

    def flows(self) -> FloatArray:
        """Return the heat on this rank by interface and mechanism [W]."""
        through = np.zeros((len(self._all), len(MECHANISMS)))
        for number, exchange in enumerate(self._all):
            if exchange is not None:
                through[number] = exchange.heat().sum(axis=1)
        return through
