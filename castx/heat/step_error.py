"""Error of the temperatures by the steps: what each adds, carried on by the linearised balance.

An implicit Euler step of size δ leaves ½ δ (q₁ − q₀) too much in a node, with the rates q₀ and q₁
at which its enthalpy changes at start and end of the step: its difference from a trapezoidal step.
What is too much flows off as the heat itself does, so that the error e of a step Δt obeys

    (V/Δt + K) e = V/Δt e_before + (heat that the step adds)/Δt

with the Jacobian of the balance at its end. That takes one factorisation and two solutions for each
step, whatever the number of its passes and sub-steps: one for the error that the steps have made,
one for the error that they would have made if all had been equally long.

Sources: K. Eriksson, D. Estep, P. Hansbo, C. Johnson, Computational Differential Equations (1996),
chapter 9, for errors that the linearised equation carries on; L. F. Shampine, SIAM J. Sci. Stat.
Comput. 5 (1984), for the filter by the Jacobian, without which fast nodes would count for too much.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray
from castx.heat.balance import HeatBalance
from castx.heat.body import ThermalBody
from castx.stateful import Arrays, Saved
from castx.transfer.pair_state import PairState

INSTANT = 1e-6
"""Part of a step in which the rates of its start are taken."""

SMALL = 1e-6
"""Largest change by which what errors store is measured, of the enthalpies of a material's data."""


@dataclass(frozen=True)
class HeatError:
    """Errors of temperatures by the steps, largest over all bodies [K].

    Attributes:
        made: by all steps so far.
        uniform: if all sub-steps had been as long as the last ones.
        substeps: of the last step.
    """

    made: float
    uniform: float
    substeps: int = 1


@dataclass(frozen=True)
class TriedStep:
    """A step with its sub-steps.

    Attributes:
        start: of the step [s].
        step: its size [s].
        substeps: their number.
        states: enthalpies of the owned nodes at its start and after each sub-step [J/m³].
    """

    start: float
    step: float
    substeps: int
    states: list[FloatArray]

    @property
    def substep(self) -> float:
        """Size of the sub-steps [s]."""
        return self.step / self.substeps

    @property
    def middle_of_last(self) -> float:
        """Part of the step at which the pairs of the last sub-step are taken."""
        return 1.0 if self.substeps == 1 else 1.0 - 0.5 / self.substeps


class HeatStepError:
    """Errors of the heat that nodes store over their volumes, committed and trial.

    Args:
        balance: of all bodies.
        solve: solves a linear system with the matrix of the balance.
    """

    def __init__(self, balance: HeatBalance, solve: Callable[[PETSc.Vec, PETSc.Vec], None]) -> None:
        self._balance, self._solve = balance, solve
        self._capacities = [_solid_capacity(body) for body in balance.bodies]
        self._small = SMALL * min(float(np.ptp(b.curve.enthalpies)) for b in balance.bodies)
        self._committed: FloatArray = np.zeros((2, balance.layout.size_local))
        self._trial = self._committed

    def estimate(
        self,
        tried: TriedStep,
        pairs: Sequence[tuple[PairState, PairState] | None],
        factors: Sequence[FloatArray] | None,
        x: PETSc.Vec,
    ) -> HeatError:
        """Return the errors at the end of a trial step, which is the state of the balance.

        Args:
            tried: the step.
            pairs: for each interface the states of its pairs at start and end of the step.
            factors: for each interface what multiplies the resistances of its pairs at the end.
            x: unknowns at the end of the step.

        Raises:
            ConvergenceError: a linear system cannot be solved; on all ranks.
        """
        balance, unknowns, substep = self._balance, self._balance.unknowns, tried.substep
        leaving = self._leaving_at_start(tried, pairs)
        before, after = (unknowns.stored(state) for state in tried.states[-2:])
        added = 0.5 * ((after - before) / substep + leaving)  # for each second of a sub-step
        balance.exchanges.set_states(pairs, tried.middle_of_last, factors)
        balance.begin(tried.states[-2], tried.states[-1], tried.start + tried.step, tried.step)
        balance.evaluate(x)
        balance.assemble_jacobian(x)
        uniform, made = self._committed
        per_substep, made = (
            self._carried(unknowns.volumes * uniform + added, tried.step),
            self._carried(unknowns.volumes * made + substep * added, tried.step),
        )
        end = tried.states[-1]
        self._trial = np.array([self._stored(end, per_substep), self._stored(end, made)])
        return HeatError(self._kelvin(made), self._kelvin(substep * per_substep), tried.substeps)

    def _leaving_at_start(
        self, tried: TriedStep, pairs: Sequence[tuple[PairState, PairState] | None]
    ) -> FloatArray:
        """Return the heat that leaves the owned nodes as the step starts [W]."""
        balance, before, instant = self._balance, tried.states[0], INSTANT * tried.step
        balance.exchanges.set_states(pairs, 0.0)
        start = balance.layout.create_vector()
        start.array[:] = balance.begin(before, before, tried.start + instant, instant)
        balance.evaluate(start)
        start.destroy()
        return balance.leaving

    def _carried(self, heat: FloatArray, step: float) -> FloatArray:
        """Return the enthalpies that a surplus of heat [J] leaves after a step [J/m³]."""
        unknowns, layout = self._balance.unknowns, self._balance.layout
        nodal, right, found = (layout.create_vector() for _ in range(3))
        nodal.array[:] = heat / step
        unknowns.gather(nodal, right)
        self._solve(right, found)
        if unknowns.groups is not None:
            unknowns.groups.spread(found.array_r[unknowns.groups.firsts], found)
        enthalpies = unknowns.slope.array_r * found.array_r
        for vector in (nodal, right, found):
            vector.destroy()
        return np.asarray(enthalpies)

    def _stored(self, enthalpies: FloatArray, error: FloatArray) -> FloatArray:
        """Return the heat that errors of enthalpies store over the volumes [J/m³]; collective.

        Where latent heat is found inside cells it is not the error itself: carried on in its place
        it would grow without end where the cells round a node store less than the node.
        """
        unknowns, comm = self._balance.unknowns, self._balance.layout.comm
        largest = comm.allreduce(float(np.abs(error).max(initial=0.0)), op=MPI.MAX)
        share = min(1.0, self._small / largest) if largest > 0.0 else 1.0
        changed = unknowns.stored(enthalpies) - unknowns.stored(enthalpies - share * error)
        return np.asarray(changed / (share * unknowns.volumes))

    def _kelvin(self, error: FloatArray) -> float:
        """Return the largest error of a temperature by errors of enthalpies; collective.

        Nodes at a melting point change no temperature: there the mean surplus of the body counts,
        which will change its temperature once it is frozen.
        """
        unknowns, comm = self._balance.unknowns, self._balance.layout.comm
        largest, sums = 0.0, np.zeros((len(unknowns.bodies), 2))
        for number, (body, part) in enumerate(zip(unknowns.bodies, unknowns.parts, strict=True)):
            free = ~unknowns.prescribed[part]
            enthalpy = body.enthalpy.x.array[: body.owned]
            changed = body.owned_temperature - body.curve.temperature(enthalpy - error[part])
            largest = max(largest, float(np.abs(changed[free]).max(initial=0.0)))
            capacity = self._capacities[number] * body.volumes.sum()
            sums[number] = body.volumes @ error[part], capacity
        surplus, capacity = np.abs(comm.allreduce(sums, op=MPI.SUM)).T
        means = surplus / np.where(capacity > 0.0, capacity, 1.0)
        return float(max(comm.allreduce(largest, op=MPI.MAX), means.max(initial=0.0)))

    def commit(self) -> None:
        """Accept the trial errors."""
        self._committed = self._trial

    def rewind(self) -> None:
        """Return to the committed errors."""
        self._trial = self._committed

    def saved(self) -> dict[str, Saved]:
        """Return the committed errors [J/m³], shape (owned, 2) for each body."""
        parts = zip(self._balance.bodies, self._balance.unknowns.parts, strict=True)
        return {
            body.name: Saved(self._committed[:, part].T.copy(), body.mesh.node_numbering)
            for body, part in parts
        }

    def restore(self, arrays: Arrays) -> None:
        """Restore committed errors."""
        committed = np.zeros_like(self._committed)
        for body, part in zip(self._balance.bodies, self._balance.unknowns.parts, strict=True):
            committed[:, part] = arrays[body.name][: body.owned].T
        self._committed = self._trial = committed


def _solid_capacity(body: ThermalBody) -> float:
    """Return the heat capacity of the solid next to its solidus [J/m³/K]."""
    curve = body.curve
    last = max(int(np.searchsorted(-curve.fractions, -1.0, side="right")) - 2, 0)
    steps = np.diff(curve.enthalpies), np.diff(curve.temperatures)
    return float(steps[0][last] / steps[1][last])
