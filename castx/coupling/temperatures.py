"""Protocol of the temperatures of all bodies, computed or prescribed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

from dolfinx import fem

from castx.arrays import FloatArray
from castx.heat.problem import HeatReport
from castx.heat.step_error import HeatError
from castx.materials.enthalpy import HeatState
from castx.stateful import Arrays, Saved
from castx.transfer.pair_state import PairState


class Temperatures(Protocol):
    """The temperatures of all bodies: a heat problem or prescribed ones.

    Attributes:
        temperature: of the nodes of each body [°C].
        enthalpy: per volume of the nodes of each body [J/m³]; none where it is not computed.
        solid_fraction: of the nodes of each body.
        solid_inside: functions that return the solid of this rank inside the cells of each body
            beside that of its nodes [m³]; collective.
    """

    temperature: dict[str, fem.Function]
    enthalpy: dict[str, fem.Function]
    solid_fraction: dict[str, fem.Function]
    solid_inside: dict[str, Callable[[], float]]

    def advance(
        self,
        time: float,
        step: float,
        pairs: Sequence[tuple[PairState, PairState] | None] = (),
        substeps: int = 1,
        dissipation: Mapping[str, FloatArray] | None = None,
        factors: Sequence[FloatArray] | None = None,
    ) -> HeatReport:
        """Find the trial state at the end of a step; arguments as of `HeatProblem.advance`."""

    def step_error(
        self,
        pairs: Sequence[tuple[PairState, PairState] | None] = (),
        factors: Sequence[FloatArray] | None = None,
    ) -> HeatError:
        """Return the errors of the temperatures by the steps, see `HeatStepError.estimate`."""

    def time_to_change(
        self, change: float, pairs: Sequence[tuple[PairState, PairState] | None] = ()
    ) -> float:
        """Return the time in which the fastest node changes by a temperature; collective."""

    def between(self, name: str) -> Sequence[HeatState]:
        """Return the states of a body inside the trial step, as far as known; collective."""

    def coefficients(self, pairs: Sequence[PairState]) -> list[FloatArray]:
        """Return h of the pairs of each interface at the trial temperatures [W/m²/K]."""

    def begin_stage(self) -> None:
        """Start a stage with the present temperatures; bodies may be new."""

    def commit(self) -> None:
        """Accept the trial state as the start of the next step."""

    def rewind(self) -> None:
        """Return to the committed state."""

    def saved(self) -> dict[str, Saved]:
        """Return the committed state as arrays."""

    def restore(self, arrays: Arrays) -> None:
        """Restore a committed state."""

    def totals(self) -> dict[str, float]:
        """Return the committed totals of heat by name."""

    def destroy(self) -> None:
        """Free the PETSc objects."""
