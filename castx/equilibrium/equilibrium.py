"""Equilibrium of all bodies in contact: solved step by step, committed or rewound."""

from __future__ import annotations

from typing import Protocol

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray
from castx.contact.kinematics.active_set import ActiveSet
from castx.contact.kinematics.gaps import Gaps
from castx.equilibrium.forces import MomentumBalance
from castx.equilibrium.newton import EquilibriumReport
from castx.equilibrium.supports.resultants import Resultant
from castx.profiling import RunPart, booked_as


class Procedure(Protocol):
    """Solves the balance of forces."""

    def begin(self) -> None:
        """Prepare for a solution: the balance has begun another one."""

    def solve(self, x: PETSc.Vec) -> EquilibriumReport:
        """Solve for the unknowns x from where they are.

        Raises:
            ConvergenceError: there is no solution to go on with.
        """

    def finish(self, x: PETSc.Vec, time: float) -> EquilibriumReport:
        """Balance the forces at a time [s] where `solve` has left them unbalanced.

        Raises:
            ConvergenceError: there is no solution to go on with.
        """

    def forget(self) -> None:
        """Drop the factors of matrices: no checkpoint has them, so no later step may use them."""

    def destroy(self) -> None:
        """Destroy the PETSc objects."""


class Equilibrium:
    """Displacements, pressures and closed pairs of one step after the other.

    Attributes:
        balance: the nonlinear problem.
        x: the unknowns of the contact method.
        committed: the owned ones after the last accepted step.

    Args:
        balance: the nonlinear problem.
        procedure: solves it.
    """

    def __init__(self, balance: MomentumBalance, procedure: Procedure) -> None:
        self.balance, self._procedure = balance, procedure
        self.x = balance.contact.layout.create_vector()
        self.committed: FloatArray = self.x.array_r.copy()

    @property
    def first(self) -> Equilibrium:
        """The equilibrium with which every step begins: this one."""
        return self

    @property
    def present(self) -> Equilibrium:
        """The equilibrium by the method at work: this one."""
        return self

    @property
    def shown(self) -> Equilibrium:
        """The equilibrium of the last solution: this one."""
        return self

    @property
    def gaps(self) -> Gaps:
        """The pairs of all interfaces."""
        return self.balance.gaps

    @property
    def active(self) -> ActiveSet:
        """The closed pairs."""
        return self.balance.active

    @booked_as(RunPart.SOLVE)
    def solve(self, time: float) -> EquilibriumReport:
        """Solve for the present state of the bodies, from the present displacements.

        Args:
            time: time of the prescribed displacements and loads [s].

        Raises:
            ConvergenceError: the iteration did not converge.
        """
        self.balance.begin(self.x, time)
        self._procedure.begin()
        return self._procedure.solve(self.x)

    @booked_as(RunPart.SOLVE)
    def finish(self, time: float) -> EquilibriumReport:
        """Balance the forces where `solve` has left them unbalanced.

        Args:
            time: time of the prescribed displacements and loads [s].

        Raises:
            ConvergenceError: the iteration did not converge.
        """
        return self._procedure.finish(self.x, time)

    def adopt(self, other: Equilibrium) -> None:
        """Adopt the accepted solution of another contact method for the same bodies."""
        size = self.balance.assembly.layout.size_local
        origins = self.balance.supports.origin, other.balance.supports.origin
        for own, given in ((self.committed, other.committed), origins):
            u = other.balance.transform.displacements(given[:size])
            own[:] = 0.0
            own[:size] = self.balance.transform.unknowns(u)
        self.balance.adopt(other.balance)
        self.rewind()

    @property
    def fallbacks(self) -> int:
        """Number of methods that have failed in this step: none before this one."""
        return 0

    def liquid_pressures(self) -> FloatArray:
        """Return the pressures of liquid columns at all rows [Pa]; collective."""
        held = self.active.held
        if not self.balance.assembly.layout.comm.allreduce(bool(held.any()), op=MPI.LOR):
            return np.zeros(len(held))
        return np.where(held, self.balance.skin.pressures(), 0.0)

    def support_force(self) -> float:
        """Return the norm of the forces of the supports [N]."""
        self.balance.set_displacements(self.x)
        return self.balance.supports.norm(self.x.array_r, self.balance.rows(self.x))

    def largest_pull(self) -> float:
        """Return the largest force by which a closed pair is pulled that no liquid holds [N].

        It is zero as long as nothing is solved; collective.
        """
        felt = self.balance.felt(self.balance.trial_forces)
        return self.active.largest_pull(felt, with_frozen=True)

    def supports(self) -> dict[str, Resultant]:
        """Return the support forces on each body, by its name; collective."""
        self.balance.set_displacements(self.x)
        return self.balance.supports.on_bodies(self.x.array_r, self.balance.rows(self.x))

    def force_errors(self) -> dict[str, float]:
        """Return the force error of each body by its name, relative to its reference force.

        It is zero as long as nothing is solved.
        """
        bodies, errors = self.balance.assembly.bodies, self.balance.convergence.errors
        return {body.name: float(error) for body, error in zip(bodies, errors, strict=True)}

    def commit(self) -> None:
        """Accept the present solution as the start of the next step."""
        self.committed = self.x.array_r.copy()
        self.balance.commit(self.x)
        self._procedure.forget()

    def rewind(self) -> None:
        """Return to the last committed solution, the displacements of the bodies included."""
        self.x.array[:] = self.committed
        self.balance.rewind(self.x)
        self._procedure.forget()

    def destroy(self) -> None:
        """Destroy the PETSc objects."""
        self._procedure.destroy()
        self.balance.skin.destroy()
        self.balance.destroy()
        self.x.destroy()
