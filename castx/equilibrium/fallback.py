"""Fallback methods: when a contact method fails in a step, the next one takes over for it."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence

from castx.equilibrium.equilibrium import Equilibrium
from castx.equilibrium.newton import EquilibriumReport
from castx.errors import ConvergenceError
from castx.solvers.diagnosis import MECHANICS

_log = logging.getLogger(__name__)


class FallbackMethods:
    """Equilibria of the same bodies by several contact methods, of which one is at work.

    Every step begins with the first method. What has taken over stays until the step is accepted
    or rewound.

    Attributes:
        first: equilibrium of the first method.
        present: that of the method at work.
        shown: that of the last solution, or of the first method after `rewind`.

    Args:
        first: equilibrium of the first method.
        others: makes the equilibria of the other methods, by their names; called when needed.
    """

    def __init__(
        self, first: Equilibrium, others: Sequence[tuple[str, Callable[[], Equilibrium]]]
    ) -> None:
        self.first, self._others = first, list(others)
        self._built: dict[str, Equilibrium] = {}
        self._failed = 0
        self.present = self.shown = first

    def solve(self, time: float) -> EquilibriumReport:
        """Solve for the present state of the bodies, by as many methods as it takes.

        Args:
            time: time of the prescribed displacements and loads [s].

        Raises:
            ConvergenceError: no method converged.
        """
        failures = []
        while True:
            try:
                report = self.present.solve(time)
            except ConvergenceError as error:
                failures.append(str(error))
                if self._failed == len(self._others):
                    raise ConvergenceError("; then ".join(failures), MECHANICS) from None
                self._take_over(error)
            else:
                self.shown = self.present
                return report

    def finish(self, time: float) -> EquilibriumReport:
        """Balance the forces where `solve` has not, by as many methods as it takes.

        Args:
            time: time of the prescribed displacements and loads [s].

        Raises:
            ConvergenceError: no method converged.
        """
        try:
            return self.present.finish(time)
        except ConvergenceError as error:
            if self._failed == len(self._others):
                raise
            self._take_over(error)
            return self.solve(time)

    def _take_over(self, error: ConvergenceError) -> None:
        name, make = self._others[self._failed]
        self._failed += 1
        _log.warning("contact by %s takes over for this step: %s", name, error)
        if name not in self._built:
            self._built[name] = make()
        self.first.rewind()
        self.present = self._built[name]
        self.present.adopt(self.first)

    @property
    def fallbacks(self) -> int:
        """Number of methods that have failed in this step."""
        return self._failed

    def commit(self) -> None:
        """Accept the present solution as the start of the next step."""
        self.present.commit()
        if self.present is not self.first:
            self.first.adopt(self.present)
        self._start_anew()

    def rewind(self) -> None:
        """Return to the last committed solution, the displacements of the bodies included."""
        self.first.rewind()
        self._start_anew()
        self.shown = self.first

    def _start_anew(self) -> None:
        self.present, self._failed = self.first, 0

    def destroy(self) -> None:
        """Destroy the PETSc objects."""
        for equilibrium in (self.first, *self._built.values()):
            equilibrium.destroy()
