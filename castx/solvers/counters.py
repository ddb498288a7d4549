"""Counters of the effort of one time step, filled where the counting happens."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass


@dataclass(kw_only=True)
class StepCounters:
    """Effort of one accepted step; the fields are columns of history.csv, in their order.

    Iterations, contact changes and passes are those of all its tries, the rejected ones included.
    Frozen pairs, unbalanced equilibria and fallbacks qualify the accepted try.

    Attributes:
        step: size of the step [s], 0 for the initial state.
        heat_iterations: Newton iterations of the heat problem.
        mechanics_iterations: Newton iterations of the mechanical problem.
        linear_iterations: iterations of the linear solves in them.
        contact_changes: changes of pairs between open and closed.
        passes: passes between heat and mechanics.
        cutbacks: tries that failed before the accepted one.
        repeats: tries that changed the state too much and were taken again, smaller.
        wall: wall clock time spent on the step [s].
        frozen_pairs: pairs that chattered between open and closed and were frozen for the step.
        unbalanced: equilibria that sweeps over blocks left before they balanced, and that a Krylov
            method ended.
        fallbacks: contact methods that failed before the one that converged.
    """

    step: float = 0.0
    heat_iterations: int = 0
    mechanics_iterations: int = 0
    linear_iterations: int = 0
    contact_changes: int = 0
    passes: int = 0
    cutbacks: int = 0
    repeats: int = 0
    wall: float = 0.0
    frozen_pairs: int = 0
    unbalanced: int = 0
    fallbacks: int = 0

    def begin_step(self) -> None:
        """Set all counters to zero."""
        for field in dataclasses.fields(self):
            setattr(self, field.name, field.default)

    def begin_try(self) -> None:
        """Set the counters that qualify the accepted try to zero."""
        self.frozen_pairs = self.unbalanced = self.fallbacks = 0

    def counts(self) -> dict[str, int]:
        """Return the counters that add up over the steps of a run, by name."""
        values = dataclasses.asdict(self)
        return {name: value for name, value in values.items() if name not in ("step", "wall")}
