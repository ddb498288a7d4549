"""Heat exchange between the facing nodes of bodies: of one interface, and of all.

Source: M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray
from castx.domain.pairs.node_pairs import NodePairs
from castx.heat.body import ThermalBody
from castx.heat.solid_feedback import SolidFeedback
from castx.solvers.layout import Layout
from castx.solvers.remote_entries import RemoteEntries
from castx.transfer.conductance import (
    PRIMARY,
    SECONDARY,
    SOLID,
    UNIT,
    Conductance,
    ConductionLaw,
    Faces,
)
from castx.transfer.duals import Dual
from castx.transfer.pair_state import PairState
from castx.transfer.radiation import emission

MECHANISMS = ("contact", "gas", "radiation")
"""How heat crosses an interface: where surfaces touch, through the gas, as radiation."""


@dataclass(frozen=True)
class HeatExchange:
    """Pairs, law and radiation of one interface.

    Attributes:
        name: of the interface: "casting/mould".
        pairs: facing nodes.
        kind: "law": by the law and radiation below; "perfect": facing nodes have one temperature;
            "none": no heat crosses.
        law: conduction through contact and gas.
        radiation: 1/(1/ε₁ + 1/ε₂ − 1) of each pair, shape (pairs,); None: nothing radiates.
    """

    name: str
    pairs: NodePairs
    kind: Literal["law", "perfect", "none"] = "law"
    law: ConductionLaw = UNIT
    radiation: FloatArray | None = None


COEFFICIENT_WITHOUT_LAW = {"perfect": np.inf, "none": 0.0}
"""h of an interface by its kind [W/m²/K]."""


def coefficients(
    exchanges: Sequence[HeatExchange], faces: Sequence[Faces | None], states: Sequence[PairState]
) -> list[FloatArray]:
    """Return h of the pairs of each interface, without radiation [W/m²/K], shape (pairs,) each.

    It is infinite in perfect contact and zero where no heat crosses.

    Args:
        exchanges: the interfaces.
        faces: their surfaces; None where there is no law.
        states: of their pairs.
    """
    return [
        np.full(len(state.gap), COEFFICIENT_WITHOUT_LAW[exchange.kind])
        if there is None
        else exchange.law(state, there).coefficient.value
        for exchange, there, state in zip(exchanges, faces, states, strict=True)
    ]


class PairExchange:
    """Heat between the nodes of one interface, Q = S (h (T_secondary − T_primary) + q_radiation).

    S is the area of a pair. Over a step the resistance 1/h is linear in time, from the state of the
    pairs at its start to that at its end, both at the present temperatures. `set_states` and
    `set_faces` come before everything else.

    Attributes:
        law: conduction through contact and gas.
        secondary: number of the secondary body.
        areas: of the pairs [m²].
        local: places of the secondary nodes among the owned ones of all bodies.
        secondary_dofs: their global numbers.
        primary_dofs: global numbers of the nodes that each of them faces, (pairs, corners).
        faces: surfaces at the last `set_faces`.

    Args:
        layout: numbering of the nodes of all bodies.
        vector: any vector of the layout.
        secondary: number of the secondary body.
        primary: number of the primary body.
        description: pairs, law and radiation of the interface.
    """

    def __init__(
        self,
        layout: Layout,
        vector: PETSc.Vec,
        secondary: int,
        primary: int,
        description: HeatExchange,
    ) -> None:
        pairs = description.pairs
        self.law, self.secondary = description.law, secondary
        self.areas = pairs.areas
        self.local = layout.local_slice(secondary).start + pairs.secondary_local
        self.secondary_dofs = layout.dofs(secondary, pairs.secondary_nodes, 0)
        partners, self._weights = pairs.partners
        self.primary_dofs = layout.dofs(primary, partners, 0)
        self._primary = RemoteEntries(vector, self.primary_dofs.ravel())
        count = len(self.areas)
        grey = np.zeros(count) if description.radiation is None else description.radiation
        self._radiating_areas = self.areas * grey
        self._start = self._end = PairState.of(np.zeros(count), np.zeros(count))
        self._part = 1.0
        self._factor: FloatArray = np.ones(count)

    def set_states(
        self, start: PairState, end: PairState, part: float, factor: FloatArray | None = None
    ) -> None:
        """Set the states of the pairs between which the step goes.

        Args:
            start: at the start of the step.
            end: at its end.
            part: of the step that has passed, between 0 and 1.
            factor: multiplies the resistance 1/h at the end, shape (pairs,); None: one.
        """
        self._start, self._end, self._part = start, end, part
        self._factor = np.ones(len(self.areas)) if factor is None else factor

    def faces_at(self, temperature: PETSc.Vec, solid_fraction: float, time: float) -> Faces:
        """Return the surfaces; collective.

        Args:
            temperature: of the nodes of all bodies [°C].
            solid_fraction: mean over the secondary body.
            time: [s].
        """
        secondary, primary = temperature.array_r[self.local], self._faced(temperature)
        return Faces.at_temperatures(secondary, primary, time, solid_fraction)

    def set_faces(self, faces: Faces) -> None:
        """Set the surfaces, and find their conductance."""
        self.faces = faces
        self._conductance = self._present_conductance()

    def _faced(self, nodal: PETSc.Vec) -> FloatArray:
        """Return a field of the primary body at the points facing the secondary nodes, (pairs,)."""
        values = self._primary.get(nodal).reshape(self._weights.shape)
        return np.asarray(np.sum(self._weights * values, axis=1))

    def _present_conductance(self) -> Conductance:
        end = self.law(self._end, self.faces)
        h_end = end.coefficient / self._factor
        if self._part >= 1.0:
            return Conductance(h_end, end.contact)
        start, part = self.law(self._start, self.faces), self._part
        h_start = start.coefficient
        resisting = h_end * (1.0 - part) + h_start * part
        passes = resisting.value > 0.0
        h = (h_start * h_end / resisting.where(passes, 1.0)).where(passes, 0.0)
        return Conductance(h, (1.0 - part) * start.contact + part * end.contact)

    def heat(self) -> FloatArray:
        """Return the heat from secondary to primary nodes [W] by mechanism and pair."""
        secondary, primary = self.faces.secondary.value, self.faces.primary.value
        conducted = self.areas * self._conductance.coefficient.value * (secondary - primary)
        radiated = self._radiating_areas * (emission(secondary)[0] - emission(primary)[0])
        contact = self._conductance.contact * conducted
        return np.stack((contact, conducted - contact, radiated))

    def add_heat(self, heat: FloatArray, balance: PETSc.Vec) -> None:
        """Add the heat that leaves the nodes to their balance, negative at the primary ones.

        Args:
            heat: from secondary to primary nodes, shape (pairs,) [W].
            balance: of all nodes [W].
        """
        np.add.at(balance.array, self.local, heat)
        self._primary.add(-(heat[:, None] * self._weights).ravel(), balance)

    def _slopes(self) -> FloatArray:
        """Return the derivatives of the heat of each pair over the variables of the law."""
        h: Dual = self._conductance.coefficient
        secondary, primary = self.faces.secondary.value, self.faces.primary.value
        slopes = self.areas * (secondary - primary) * h.slopes
        slopes[SECONDARY] += self.areas * h.value + self._radiating_areas * emission(secondary)[1]
        slopes[PRIMARY] -= self.areas * h.value + self._radiating_areas * emission(primary)[1]
        return slopes

    def solid_slope(self) -> FloatArray:
        """Return the derivative of the heat over the solid fraction, shape (pairs,) [W]."""
        return np.asarray(self._slopes()[SOLID])

    def derivatives(self, temperature_slope: PETSc.Vec) -> FloatArray:
        """Return the derivatives of the balances of all nodes of a pair over their unknowns.

        Args:
            temperature_slope: of the nodes over their unknown.

        Returns:
            For each pair the rows secondary, primary, … and in them the columns secondary,
            primary, …, shape (pairs, 1 + corners, 1 + corners).
        """
        slopes = self._slopes()
        there = self._primary.get(temperature_slope).reshape(self._weights.shape)
        here = slopes[SECONDARY] * temperature_slope.array_r[self.local]
        row = np.column_stack((here, slopes[PRIMARY][:, None] * self._weights * there))
        shares = np.column_stack((np.ones(len(here)), -self._weights))
        return np.asarray(shares[:, :, None] * row[:, None, :])


class Exchanges:
    """Exchange of heat at all interfaces; interfaces without a law are insulated.

    Attributes:
        under_law: exchange at the interfaces that have a law.
        fed_back: those of them whose law depends on the solid fraction of a whole body.
        feedback: these solid fractions.

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
        self.fed_back = [e for e in self.under_law if e.law.needs_solid_fraction]
        self.feedback = SolidFeedback(layout, bodies, {e.secondary for e in self.fed_back})

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

    def faces_at(self, temperature: PETSc.Vec, time: float) -> list[Faces | None]:
        """Return the surfaces of each interface, None where it has no law; collective.

        Args:
            temperature: of the nodes of all bodies [°C].
            time: [s].
        """
        means = self.feedback.means()
        return [
            None
            if exchange is None
            else exchange.faces_at(temperature, float(means[exchange.secondary]), time)
            for exchange in self._all
        ]

    def update_faces(self, temperature: PETSc.Vec, time: float) -> None:
        """Update the surfaces and their conductance; arguments as of `faces_at`; collective."""
        for exchange, faces in zip(self._all, self.faces_at(temperature, time), strict=True):
            if exchange is not None and faces is not None:
                exchange.set_faces(faces)

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
