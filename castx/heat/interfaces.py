"""The exchange of heat through all interfaces of a heat problem."""

from __future__ import annotations

from collections.abc import Sequence

from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray
from castx.heat.body import ThermalBody
from castx.heat.interface import MECHANISMS, HeatExchange, PairExchange
from castx.heat.solid_feedback import SolidFeedback
from castx.solvers.layout import Layout
from castx.transfer.pair_state import PairState


class Exchanges:
    """All interfaces; those without a law have nothing to exchange here.

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

    def face(self, temperature: PETSc.Vec, time: float) -> None:
        """Take the surfaces as they are at a time [s]; temperatures in the layout [°C]."""
        means = self.feedback.means()
        for exchange in self.under_law:
            exchange.face(temperature, float(means[exchange.secondary]), time)

    def coefficients(self, states: Sequence[PairState]) -> list[FloatArray]:
        """Return h of pairs in these states as the surfaces are now [W/m²/K].

        It is infinite where bodies are bonded and zero where no heat crosses.
        """
        fixed = {"perfect": np.inf, "none": 0.0}
        return [
            np.full(len(state.gap), fixed[kind])
            if exchange is None
            else exchange.coefficient(state)
            for exchange, kind, state in zip(self._all, self._kinds, states, strict=True)
        ]

    def add_heat(self, balance: PETSc.Vec) -> float:
        """Add what leaves the nodes to their balance and return the sum of all amounts [W]."""
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
