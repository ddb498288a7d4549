"""Interfaces as the coupling of heat and mechanics sees them, and the states of their pairs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.domain.pairs.node_pairs import NodePairs
from castx.stateful import Arrays, Saved, number, part_of
from castx.transfer.pair_state import PairState

WITH_FEEDBACK = ("staggered", "iterated")
"""Coupling schemes in which heat transfer depends on the present gaps and pressures."""


@dataclass(frozen=True)
class CoupledInterface:
    """An interface, with or without contact, that heat crosses or not.

    Attributes:
        name: "secondary/primary".
        pairs: its node pairs.
        contact: number of the interface among those with contact; None: it has none.
        clearance: gap from which its surfaces touch [m].
    """

    name: str
    pairs: NodePairs
    contact: int | None
    clearance: float = 0.0


class Interfaces:
    """States of the pairs of all interfaces, committed and trial.

    Attributes:
        described: the interfaces in the order of the heat problem.
        states: trial states of their pairs.
        resistances: trial resistances R = 1/h of their pairs without radiation [m² K/W], shape
            (pairs,) each.
        areas: of all pairs, one interface after the other [m²].
        committed_step: size of the last accepted step [s]; 1 s before the first one.

    Args:
        described: the interfaces in the order of the heat problem.
        scheme: of the coupling.
    """

    def __init__(self, described: Sequence[CoupledInterface], scheme: str) -> None:
        self.described, self._scheme = list(described), scheme
        self.states = [initial_state(interface) for interface in described]
        self.resistances: list[FloatArray] = [np.ones(len(s.gap)) for s in self.states]
        self.areas: FloatArray = np.concatenate(
            [np.zeros(0), *(np.asarray(interface.pairs.areas) for interface in described)]
        )
        self._initial = self._clipped(self.states)
        self._gap_rates: list[FloatArray] = [np.zeros(len(s.gap)) for s in self.states]
        self.committed_step = 1.0
        self._committed = list(self.states)
        self._committed_resistances = list(self.resistances)

    def begin(self, resistances: Sequence[FloatArray]) -> None:
        """Set the resistances of the initial state [m² K/W]."""
        self.resistances = list(resistances)
        self._committed_resistances = list(resistances)

    def number(self, name: str) -> int:
        """Return the number of an interface by its name."""
        return [interface.name for interface in self.described].index(name)

    def update(self, contacts: Sequence[PairState]) -> None:
        """Take the states of the pairs of all interfaces with contact from the equilibrium."""
        for i, interface in enumerate(self.described):
            if interface.contact is not None:
                self.states[i] = contacts[interface.contact]

    def thermal(self) -> list[PairState]:
        """Return the trial states on which heat transfer depends."""
        return self._thermal(self.states)

    def thermal_at_start(self) -> list[PairState]:
        """Return the states at the start of the step on which heat transfer depends."""
        return self._thermal(self._committed)

    def _thermal(self, states: Sequence[PairState]) -> list[PairState]:
        return self._clipped(states) if self._scheme in WITH_FEEDBACK else self._initial

    def _clipped(self, states: Sequence[PairState]) -> list[PairState]:
        return [
            state.clipped(interface.clearance)
            for state, interface in zip(states, self.described, strict=True)
        ]

    def _changes(self) -> list[FloatArray]:
        """Return the changes of open gaps in the trial step [m], shape (pairs,) each."""
        both = zip(self._clipped(self.states), self._clipped(self._committed), strict=True)
        return [new.gap - old.gap for new, old in both]

    def largest_change(self) -> float:
        """Return the largest change of an open gap in the trial step on this rank [m]."""
        changes = (np.abs(change).max(initial=0.0) for change in self._changes())
        return float(max(changes, default=0.0))

    def first_guess(self, step: float) -> list[PairState]:
        """Return the states with which heat begins a step [s]: gaps extrapolated in time."""
        if self._scheme != "iterated":
            return self.thermal_at_start()
        return [
            PairState.of(state.gap + step * rate, state.pressure)
            for state, rate in zip(self._clipped(self._committed), self._gap_rates, strict=True)
        ]

    def commit(self, step: float) -> None:
        """Accept the trial states as the start of the next step.

        Args:
            step: size of the accepted step [s].
        """
        self._gap_rates = [np.asarray(change / step) for change in self._changes()]
        self._committed, self.committed_step = list(self.states), step
        self._committed_resistances = list(self.resistances)

    def settle(self) -> None:
        """Accept the trial states as the initial ones, from which gaps have not grown yet."""
        self._committed = list(self.states)
        self._committed_resistances = list(self.resistances)

    def rewind(self) -> None:
        """Return to the committed states."""
        self.states = list(self._committed)
        self.resistances = list(self._committed_resistances)

    def saved(self) -> dict[str, Saved]:
        """Return the committed states, resistances and rates of the gaps."""
        found = {"step": number(self.committed_step)}
        for interface, state, resistance, rate in zip(
            self.described, self._committed, self._committed_resistances, self._gap_rates,
            strict=True,
        ):  # fmt: skip
            arrays = {**vars(state), "resistance": resistance, "gap_rate": rate}
            for name, values in arrays.items():
                found[f"{interface.name}/{name}"] = Saved(values, interface.pairs.numbering)
        return found

    def restore(self, arrays: Arrays) -> None:
        """Restore committed states; `rewind` makes them the trial states."""
        self.committed_step = float(arrays["step"])
        states = [part_of(arrays, interface.name) for interface in self.described]
        self._gap_rates = [state.pop("gap_rate") for state in states]
        self._committed_resistances = [state.pop("resistance") for state in states]
        self._committed = [PairState(**state) for state in states]


def initial_state(interface: CoupledInterface) -> PairState:
    """Return the state of the pairs of an interface before anything moves."""
    gap = interface.pairs.gap.copy()
    force = np.zeros_like(interface.pairs.area_vectors)
    none = np.zeros(len(gap))
    return PairState(gap, none, gap <= 0, force, none)
