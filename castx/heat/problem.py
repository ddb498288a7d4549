"""The heat problem of all bodies: nodal enthalpy, implicit Euler, exchange through node pairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np

from castx.arrays import FloatArray
from castx.domain.mesh import CastingMesh
from castx.errors import CaseError, ConvergenceError
from castx.heat.balance import HeatBalance
from castx.heat.body import HeatBody, ThermalBody
from castx.heat.boundaries import SurfaceFlux, SurfaceHeat, SurfaceTemperature
from castx.heat.interface import HeatExchange, coefficients
from castx.heat.ledger import Accounts, HeatBooks, accounts_of, divided_places
from castx.heat.newton import PREFIX, adjust_step, converged, default_options, jacobian, residual
from castx.heat.pace import time_to_change
from castx.heat.step_error import HeatError, HeatStepError, TriedStep
from castx.heat.unknowns import HeatUnknowns
from castx.materials.enthalpy import HeatState
from castx.profiling import RunPart, booked_as
from castx.solvers.counters import StepCounters
from castx.solvers.diagnosis import HEAT
from castx.solvers.layout import Layout
from castx.solvers.snes import NonlinearSolver, SolveReport
from castx.solvers.worst_place import Part, worst_place
from castx.stateful import Arrays, Saved, joined, part_of
from castx.transfer.pair_state import PairState


@dataclass(frozen=True)
class HeatReport:
    """Iterations of a trial step, and its largest change of temperature.

    Attributes:
        iterations: Newton iterations of all sub-steps.
        linear_iterations: iterations of their linear solves.
        largest_temperature_change: since the start of the step [K], over all nodes whose
            temperature is not prescribed.
    """

    iterations: int
    linear_iterations: int
    largest_temperature_change: float


class HeatProblem:
    """Temperature and enthalpy of all bodies, committed and trial.

    Gaps grow all through a step, from resistances R₀ of the pairs to R₁: the k-th of n sub-steps
    takes those of its middle, R = R₀ + (k − ½)(R₁ − R₀)/n. A step without sub-steps takes R₁, so
    that one that is large leads to the steady state.

    Args:
        mesh: of all bodies.
        bodies: one for each body of the mesh; their order numbers the unknowns.
        exchanges: interfaces; the states of the pairs of each step come in this order.
        surfaces: heat conditions; a surface without one is insulated. Where prescribed temperatures
            meet, the first applies.
        tolerance: of the balance, relative to the heat that changes place in the sub-step.
        linear: "direct", "iterative" or "automatic", by size.
        options: PETSc options without the prefix `castx_heat_`; they override the defaults, but the
            iteration is stopped by `tolerance` alone.
        accounts: of the whole run, if it has other stages; by default the own ones.
        counters: of the step, to which iterations are added.

    Raises:
        CaseError: a body is missing or unknown.
        MeshError: a body has no such surface.
    """

    def __init__(
        self,
        mesh: CastingMesh,
        bodies: Sequence[HeatBody],
        exchanges: Sequence[HeatExchange] = (),
        surfaces: Sequence[SurfaceHeat] = (),
        *,
        tolerance: float = 1e-8,
        linear: Literal["direct", "iterative", "automatic"] = "automatic",
        options: Mapping[str, Any] | None = None,
        accounts: Accounts | None = None,
        counters: StepCounters | None = None,
    ) -> None:
        self._comm = mesh.comm
        self._exchanges = tuple(exchanges)
        self._balance = heat_balance(mesh, bodies, exchanges, surfaces)
        self._unknowns, self._bodies = self._balance.unknowns, self._balance.bodies
        self._layout = self._balance.layout
        self.temperature = {body.name: body.temperature for body in self._bodies}
        self.enthalpy = {body.name: body.enthalpy for body in self._bodies}
        self.solid_fraction = {body.name: body.solid_fraction for body in self._bodies}
        self.solid_inside = {body.name: body.solid_inside for body in self._bodies}
        dimension = mesh.parent.topology.dim
        defaults = default_options(linear, self._layout.size_global, dimension)
        given = dict(options or {})
        self._solver = NonlinearSolver(
            HEAT,
            PREFIX,
            partial(residual, self._balance),
            partial(jacobian, self._balance),
            vector=self._balance.residual,
            matrix=self._balance.jacobian.matrix,
            options=defaults | given,
            converged=partial(converged, self._balance, tolerance, "ksp_rtol" not in given),
            step_rule=partial(adjust_step, self._balance),
        )
        self._counters = counters or StepCounters()
        self._error = HeatStepError(self._balance, self._solver.solve_linear)
        self._unknown = self._layout.create_vector()
        interfaces = [(item.pairs.secondary, item.pairs.primary) for item in exchanges]
        divided = divided_places([surfaces]) if accounts is None else accounts.divided
        own = accounts_of(list(self.temperature), surfaces, interfaces, divided)
        self._books = HeatBooks(mesh.comm, self._bodies, own, accounts)
        self._ledger = self._books.ledger
        self.begin_stage()
        self._substates: list[FloatArray] = []
        self._tried: tuple[float, float, int] = (0.0, 0.0, 1)

    def begin_stage(self) -> None:
        """Book the heat of renewed bodies; bring nodes in perfect contact to one temperature."""
        self._books.begin_stage(self._unknowns.equalise)
        self.commit()

    @booked_as(RunPart.HEAT)
    def advance(
        self,
        time: float,
        step: float,
        pairs: Sequence[tuple[PairState, PairState] | None] = (),
        substeps: int = 1,
        dissipation: Mapping[str, FloatArray] | None = None,
        factors: Sequence[FloatArray] | None = None,
    ) -> HeatReport:
        """Find the trial state at the end of a step that starts from the committed state.

        A repeated call for the same step starts its iterations from the last result and what has
        changed since then in the last two sub-steps, another one from what these let expect.

        Args:
            time: start of the step [s].
            step: its size [s].
            pairs: for each interface the states of its pairs at start and end of the step; None
                where it has no law.
            substeps: implicit Euler steps of equal size inside the step.
            dissipation: heat of plastic work at the owned nodes of bodies [W].
            factors: for each interface what multiplies the resistances 1/h of its pairs at the end
                of the step, shape (pairs,); None: one.

        Raises:
            ConvergenceError: names body and place of the largest residual.
        """
        self._ledger.rewind()
        self._balance.set_dissipation(dissipation or {})
        known = self._substates if self._tried == (time, step, substeps) else []
        self._tried = (time, step, substeps)
        self._substates = []
        before = state = self._committed
        size = step / substeps
        changed = changed_before = np.zeros_like(state)
        iterations, linear_iterations = 0, 0
        for k in range(1, substeps + 1):
            part = (k - 0.5) / substeps if substeps > 1 else 1.0
            self._balance.exchanges.set_states(pairs, part, factors)
            again = k <= len(known)
            # The pass before and its change go on, or else the last substep does.
            guess = known[k - 1] + 2.0 * changed - changed_before if again else 2.0 * state - before
            x = self._balance.begin(state, guess, time + k * size, size)
            report = self._solve(x)
            before, state = state, self._unknowns.enthalpies()
            if again:
                changed_before, changed = changed, state - known[k - 1]
            self._substates.append(state)
            self._books.book(self._balance.flows(), self._balance.sums().moved, size)
            iterations += report.iterations
            linear_iterations += report.linear_iterations
        return HeatReport(iterations, linear_iterations, self._largest_temperature_change())

    def time_to_change(
        self, change: float, pairs: Sequence[tuple[PairState, PairState] | None] = ()
    ) -> float:
        """Return the time in which the fastest node changes by a temperature; collective.

        Args:
            change: of its temperature [K].
            pairs: for each interface the states of its pairs, as of `advance`.
        """
        self._balance.exchanges.set_states(pairs, 1.0)
        found = time_to_change(self._balance, self._committed, change)
        self.rewind()
        return found

    @booked_as(RunPart.HEAT)
    def step_error(
        self,
        pairs: Sequence[tuple[PairState, PairState] | None] = (),
        factors: Sequence[FloatArray] | None = None,
    ) -> HeatError:
        """Return the errors of the temperatures by the steps, see `HeatStepError.estimate`."""
        tried = TriedStep(*self._tried, [self._committed, *self._substates])
        return self._error.estimate(tried, pairs, factors, self._unknown)

    def between(self, name: str) -> Sequence[HeatState]:
        """Return the states of a body at the ends of the sub-steps but the last; collective.

        Args:
            name: of the body.
        """
        number = [body.name for body in self._bodies].index(name)
        part = self._layout.local_slice(number)
        return [self._bodies[number].state(state[part]) for state in self._substates[:-1]]

    def _solve(self, x: FloatArray) -> SolveReport:
        self._unknown.array[:] = x
        try:
            return self._solver.solve(self._unknown)
        except ConvergenceError as error:
            raise ConvergenceError(f"{error}; {self._worst_node()}", HEAT) from None
        finally:
            self._counters.heat_iterations += self._solver.snes.getIterationNumber()

    def _worst_node(self) -> str:
        """Return the place of the largest residual as a text, the same on all ranks."""
        values = self._balance.residual.array_r
        parts = [
            Part(
                f"body {body.name!r}",
                values[self._layout.local_slice(number)],
                body.mesh.points[: body.owned],
            )
            for number, body in enumerate(self._bodies)
        ]
        return worst_place(self._comm, parts, "W")

    def _largest_temperature_change(self) -> float:
        largest = 0.0
        for number, body in enumerate(self._bodies):
            part = self._layout.local_slice(number)
            change = np.abs(body.owned_temperature - body.curve.temperature(self._committed[part]))
            largest = max(largest, change[~self._unknowns.prescribed[part]].max(initial=0.0))
        return float(max(self._comm.allgather(float(largest))))

    def coefficients(self, pairs: Sequence[PairState]) -> list[FloatArray]:
        """Return h of pairs in these states at the trial temperatures [W/m²/K]; collective.

        It is infinite in perfect contact and zero where no heat crosses.

        Args:
            pairs: state of the pairs of each interface.
        """
        self._unknowns.read_temperatures()
        temperature, time = self._unknowns.temperature, self._balance.time
        faces = self._balance.exchanges.faces_at(temperature, time)
        return coefficients(self._exchanges, faces, pairs)

    def commit(self) -> None:
        """Accept the trial state as the start of the next step."""
        self._committed = self._unknowns.enthalpies()
        self._error.commit()
        self._ledger.commit()

    def rewind(self) -> None:
        """Return to the committed state."""
        self._unknowns.set_enthalpies(self._committed)
        self._error.rewind()
        self._ledger.rewind()

    def saved(self) -> dict[str, Saved]:
        """Return the committed enthalpies and the ledger."""
        enthalpies = {
            body.name: Saved(
                self._committed[self._layout.local_slice(number)].copy(), body.mesh.node_numbering
            )
            for number, body in enumerate(self._bodies)
        }
        parts = {"ledger": self._ledger.saved(), "step_error": self._error.saved()}
        return joined({"enthalpy": enthalpies, **parts})

    def restore(self, arrays: Arrays) -> None:
        """Restore a saved state as the committed one."""
        for number, body in enumerate(self._bodies):
            enthalpy = arrays[f"enthalpy/{body.name}"]
            self._committed[self._layout.local_slice(number)] = enthalpy[: body.owned]
        self._ledger.restore(part_of(arrays, "ledger"))
        self._error.restore(part_of(arrays, "step_error"))
        self.rewind()

    def totals(self) -> dict[str, float]:
        """Return the committed totals of heat by name [J], see `Ledger.totals`."""
        return self._ledger.totals()

    def destroy(self) -> None:
        """Free the PETSc objects."""
        self._solver.destroy()
        self._balance.destroy()
        self._unknown.destroy()


def heat_balance(
    mesh: CastingMesh,
    bodies: Sequence[HeatBody],
    exchanges: Sequence[HeatExchange],
    surfaces: Sequence[SurfaceHeat],
) -> HeatBalance:
    """Return the balance of all bodies; see `HeatProblem` for the arguments.

    Raises:
        CaseError: a body is missing or unknown.
        MeshError: a body has no such surface.
    """
    built = _build_bodies(mesh, bodies, surfaces)
    named = {body.name: body for body in built}
    layout = Layout(mesh.comm, [body.index_map for body in built], [1] * len(built))
    given = [SurfaceTemperature(named[s.body], s) for s in surfaces if s.gives_temperature]
    fluxes = [SurfaceFlux(named[s.body], s) for s in surfaces if s.gives_flux]
    return HeatBalance(HeatUnknowns(layout, built, exchanges, given), exchanges, fluxes)


def _build_bodies(
    mesh: CastingMesh, bodies: Sequence[HeatBody], surfaces: Sequence[SurfaceHeat]
) -> list[ThermalBody]:
    names = [body.name for body in bodies]
    if sorted(names) != sorted(mesh.bodies):
        raise CaseError(
            f"the heat problem needs each of the bodies {', '.join(mesh.bodies)} once, "
            f"got {', '.join(names)}"
        )
    for surface in surfaces:
        if surface.body not in names:
            raise CaseError(
                f"heat condition on {surface.name}: no body {surface.body!r}; "
                f"there are {', '.join(names)}"
            )
        mesh.bodies[surface.body].surface_tag(surface.surface)
    return [ThermalBody(mesh.bodies[body.name], mesh.model, body) for body in bodies]
