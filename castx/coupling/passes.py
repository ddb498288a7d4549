"""Passes between heat and mechanics in a step: whether they agree, go round, or are for nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from castx.coupling.agreement import ROUNDED
from castx.coupling.change import StepChange, ThermalChange
from castx.coupling.relaxation import goes_round
from castx.errors import ConvergenceError
from castx.solvers.diagnosis import CIRCLING, COUPLING

SETTLED = 1e-6
"""Change of a pass from which on further ones say nothing of the size of the next step: with a
tolerance near rounding it is rounding that chooses how many there are."""
HOPELESS = 3
"""Passes one after the other in which a step changes too much, after which it is given up."""


class Passes:
    """The passes of one try of a step.

    Attributes:
        changes: of the resistances in each pass.

    Args:
        tolerance: change of the resistances within which passes agree.
        too_much: tells of a change whether the step will be taken again, the same on all ranks.
    """

    def __init__(self, tolerance: float, too_much: Callable[[StepChange], bool]) -> None:
        self._tolerance, self._too_much = tolerance, too_much
        self.changes: list[float] = []
        self._at_rest, self._hopeless = False, 0

    def add(self, change: float, at_rest: bool) -> None:
        """Count a pass.

        Args:
            change: of the resistances, the same on all ranks.
            at_rest: whether it moved no force by more than rounding.
        """
        self.changes.append(change)
        self._at_rest = at_rest

    @property
    def go_round(self) -> bool:
        """Whether passes no longer come closer to each other."""
        return goes_round(self.changes)

    @property
    def agree(self) -> bool:
        """Whether the last pass has changed nothing that counts."""
        rounded = ROUNDED if self._at_rest or self.go_round else 0.0
        return self.changes[-1] <= max(self._tolerance, rounded)

    def changed(self, temperature: float, thermal: ThermalChange, skin: float) -> StepChange:
        """Return the change of the state after the last pass; collective.

        Args:
            temperature: largest change of a node [K].
            thermal: change of the solid fraction.
            skin: growth of the fastest skin.
        """
        return StepChange(
            passes=len(self.changes),
            settled=1 + sum(before > SETTLED for before in self.changes[:-1]),
            temperature=temperature,
            solid_fraction=thermal.largest_of_solid_fraction(),
            mean_solid_fraction=thermal.largest_of_mean_solid_fraction(),
            skin=skin,
        )

    def given_up(self, change: StepChange) -> StepChange | None:
        """Return the change of a step that further passes are for nothing in; None: they are not.

        Args:
            change: of the state after the last pass.
        """
        self._hopeless = self._hopeless + 1 if self._too_much(change) else 0
        return replace(change, agreed=False) if self._hopeless == HOPELESS else None

    def failure(self) -> ConvergenceError:
        """Return the error of passes that do not agree, with what would help."""
        count, still = len(self.changes), f"change by {self.changes[-1]:.2g} of their values"
        if self.go_round:
            return ConvergenceError(
                f"the interfaces no longer came closer to each other in {count} passes: their "
                f"resistances still {still}",
                CIRCLING,
            )
        return ConvergenceError(
            f"the interfaces did not agree in {count} passes (coupling.passes): their resistances "
            f"still {still}",
            COUPLING,
        )
