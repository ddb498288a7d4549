"""Error of the temperatures by the steps: what each adds, carried on by the linearised balance.

An implicit Euler step of size δ leaves ½ δ (q₁ − q₀) too much in a node, with the rates q₀ and q₁
at which its enthalpy changes at start and end of the step: its difference from a trapezoidal step.
What is too much flows off as the heat itself does, so that the error e of a step Δt obeys

    (V/Δt + K) e = V/Δt e_before + (heat that the step adds)/Δt

with the Jacobian of the balance at its end. That takes one factorisation and two solutions for each
step, whatever the number of its passes and sub-steps: one for the error that the steps have made,
one for the error that they would have made if all had been equally long.

At a melting point an error of the enthalpy changes no temperature, but it delays the front by the
time t = Σ V e/Σ Q in which the surplus of all nodes there goes with the heat Q that leaves them.
For so long the last of them stay hot where they should cool as solid. This error is found in
advance, by one more linear step as long as the delay, in which these nodes are solid.

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
        parts = zip(balance.bodies, balance.unknowns.parts, strict=True)
        self._solid_slope: FloatArray = np.empty(balance.layout.size_local)
        for body, part in parts:
            self._solid_slope[part] = 1.0 / _solid_capacity(body)
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
        end, cooling = tried.states[-1], np.asarray((before - after) / substep)
        self._trial = np.array([self._stored(end, per_substep), self._stored(end, made)])
        late_made = self._of_late_nodes(made, cooling)
        late_uniform = self._of_late_nodes(substep * per_substep, cooling)
        return HeatError(
            max(self._kelvin(made), late_made),
            max(self._kelvin(substep * per_substep), late_uniform),
            tried.substeps,
        )

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

        Of nodes at a melting point it is in advance that of the front, see `_of_late_nodes`. The
        mean surplus of a body counts as well: it stays when all of the body is solid.
        """
        unknowns, comm = self._balance.unknowns, self._balance.layout.comm
        largest, sums = 0.0, np.zeros((len(unknowns.bodies), 2))
        for number, (body, part) in enumerate(zip(unknowns.bodies, unknowns.parts, strict=True)):
            counted = ~unknowns.prescribed[part] & (body.temperature_slope() > 0.0)
            enthalpy = body.enthalpy.x.array[: body.owned]
            changed = body.owned_temperature - body.curve.temperature(enthalpy - error[part])
            largest = max(largest, float(np.abs(changed[counted]).max(initial=0.0)))
            capacity = body.volumes @ (1.0 / self._solid_slope[part])
            sums[number] = body.volumes @ error[part], capacity
        surplus, capacity = np.abs(comm.allreduce(sums, op=MPI.SUM)).T
        means = surplus / np.where(capacity > 0.0, capacity, 1.0)
        return float(max(comm.allreduce(largest, op=MPI.MAX), means.max(initial=0.0)))

    def _of_late_nodes(self, error: FloatArray, cooling: FloatArray) -> float:
        """Return the error of a temperature that nodes at a melting point will make; collective.

        Args:
            error: of the enthalpies [J/m³].
            cooling: heat by which the nodes store less each second [W].
        """
        balance, unknowns = self._balance, self._balance.unknowns
        # Nodes that share their unknown touch another body, and do not freeze last.
        late = (unknowns.temperature_slope.array_r == 0.0) & (unknowns.slope.array_r == 1.0)
        late &= ~unknowns.prescribed
        sums = np.array([(unknowns.volumes * error)[late].sum(), cooling[late].sum()])
        surplus, leaving = balance.layout.comm.allreduce(sums, op=MPI.SUM)
        if surplus * leaving <= 0.0:
            return 0.0
        slope = balance.layout.create_vector()
        slope.array[:] = np.where(late, self._solid_slope, unknowns.temperature_slope.array_r)
        delay = float(surplus / leaving)
        balance.assemble_with(slope, delay)
        changed = self._carried(unknowns.volumes * error, delay) * slope.array_r
        slope.destroy()
        largest = float(np.abs(changed[~unknowns.prescribed]).max(initial=0.0))
        return float(balance.layout.comm.allreduce(largest, op=MPI.MAX))

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
