"""Fallback methods: when a contact method fails in a step, the next one takes over for it."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence

from petsc4py import PETSc

from castx.arrays import FloatArray
from castx.contact.kinematics.active_set import ActiveSet
from castx.contact.kinematics.gaps import Gaps
from castx.equilibrium.equilibrium import Equilibrium
from castx.equilibrium.forces import MomentumBalance
from castx.equilibrium.newton import EquilibriumReport
from castx.equilibrium.supports.resultants import Resultant
from castx.errors import ConvergenceError
from castx.solvers.diagnosis import MECHANICS

_log = logging.getLogger(__name__)


class FallbackMethods:
    """Equilibria of the same bodies by several contact methods, of which one is at work.

    Every step begins with the first method. What has taken over stays until the step is accepted
    or rewound.

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
        self._present = self._shown = first

    @property
    def balance(self) -> MomentumBalance:
        """The nonlinear problem of the method at work."""
        return self._present.balance

    @property
    def x(self) -> PETSc.Vec:
        """The unknowns of the method at work."""
        return self._present.x

    @property
    def gaps(self) -> Gaps:
        """The pairs of the method at work."""
        return self._present.gaps

    @property
    def active(self) -> ActiveSet:
        """The closed pairs of the method at work."""
        return self._present.active

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
                report = self._present.solve(time)
            except ConvergenceError as error:
                failures.append(str(error))
                if self._failed == len(self._others):
                    raise ConvergenceError("; then ".join(failures), MECHANICS) from None
                self._take_over(error)
            else:
                self._shown = self._present
                return report

    def finish(self, time: float) -> EquilibriumReport:
        """Balance the forces where `solve` has not, by as many methods as it takes.

        Args:
            time: time of the prescribed displacements and loads [s].

        Raises:
            ConvergenceError: no method converged.
        """
        try:
            return self._present.finish(time)
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
        self._present = self._built[name]
        self._present.adopt(self.first)

    @property
    def fallbacks(self) -> int:
        """Number of methods that have failed in this step."""
        return self._failed

    def pair_values(self) -> tuple[FloatArray, FloatArray]:
        """Return gaps [m] and contact forces [N] of all rows of this rank, no force where open."""
        return self._present.pair_values()

    def liquid_pressures(self) -> FloatArray:
        """Return the pressures of liquid columns at all rows [Pa]; collective."""
        return self._present.liquid_pressures()

    def along_surface(self) -> FloatArray | None:
        """Return the friction on the secondary nodes of all rows [N]; None: there is none."""
        return self._present.along_surface()

    def support_force(self) -> float:
        """Return the norm of the forces of the supports in the last solution [N]."""
        return self._shown.support_force()

    def largest_pull(self) -> float:
        """Return the largest force by which a closed pair is pulled in the last solution [N]."""
        return self._shown.largest_pull()

    def supports(self) -> dict[str, Resultant]:
        """Return the support forces on each body in the last solution, by its name; collective."""
        return self._shown.supports()

    def force_errors(self) -> dict[str, float]:
        """Return the missing part of the balance of each body in the last solution, relative."""
        return self._shown.force_errors()

    def commit(self) -> None:
        """Accept the present solution as the start of the next step."""
        self._present.commit()
        if self._present is not self.first:
            self.first.adopt(self._present)
        self._start_anew()

    def rewind(self) -> None:
        """Return to the last committed solution, the displacements of the bodies included."""
        self.first.rewind()
        self._start_anew()
        self._shown = self.first

    def _start_anew(self) -> None:
        self._present, self._failed = self.first, 0

    def destroy(self) -> None:
        """Destroy the PETSc objects."""
        for equilibrium in (self.first, *self._built.values()):
            equilibrium.destroy()
