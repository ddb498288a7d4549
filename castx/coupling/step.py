"""One thermo-mechanical step: heat, equilibrium, new gaps, until the interfaces agree.

The unknown of the passes is the thermal resistance R = 1/h of every pair, which is linear in an
open gap. Aitken's factor for each pair breaks the two-cycle into which the plain iteration falls at
large steps; the first guess comes from the gap extrapolated in time. Where h depends on temperature
too, the R that were tried and found are compared at the temperatures of the pass, and heat is given
the gaps and pressures that were found with the factors that turn their R into the wanted ones;
radiation takes no part, since neither gap nor pressure change it.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection, Mapping, Sequence

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.coupling.agreement import disagreement
from castx.coupling.change import StepChange, StepErrors, ThermalChange
from castx.coupling.dissipation import Dissipation
from castx.coupling.interface import WITH_FEEDBACK, CoupledInterface, Interfaces
from castx.coupling.melt_flow import flowing
from castx.coupling.passes import Passes
from castx.coupling.relaxation import Relaxation, scaling
from castx.coupling.temperatures import Temperatures
from castx.equilibrium.problem import MechanicalProblem
from castx.errors import ConvergenceError
from castx.profiling import RunPart, booked_as
from castx.solvers.counters import StepCounters
from castx.solvers.finite import require_finite
from castx.stateful import Arrays, Saved, Stateful, restore_parts, saved_parts
from castx.transfer.pair_state import PairState

log = logging.getLogger(__name__)
INSTANT = 1e-9
"""Step in which nothing flows [s]."""
SMALLEST_STRAIN = 1e-12
"""Thermal strain that counts as none."""


class CoupledProblem:
    """Heat and mechanics of all bodies, committed and trial.

    Attributes:
        heat: temperatures of all bodies.
        mechanics: the equilibrium; None: thermal only.
        interfaces: states of the pairs of all interfaces.
        volumes: of the owned nodes of each body [m³].
        counters: of the present step, all its tries together.

    Args:
        comm: ranks.
        heat: temperatures of all bodies.
        mechanics: the equilibrium; None: thermal only.
        interfaces: all interfaces of the heat problem, in its order.
        volumes: of the owned nodes of each body [m³].
        scheme: "thermal", "mechanical", "one-way", "staggered" or "iterated".
        tolerance: relative change of the resistances between the last two passes, see `agreement`.
        most_passes: passes after which the step has failed.
        counters: of the step, to which heat and mechanics add as well.
    """

    def __init__(
        self,
        comm: MPI.Intracomm,
        heat: Temperatures,
        mechanics: MechanicalProblem | None,
        interfaces: Sequence[CoupledInterface],
        volumes: Mapping[str, FloatArray],
        scheme: str,
        tolerance: float,
        most_passes: int,
        counters: StepCounters,
    ) -> None:
        self.comm, self.heat, self.mechanics = comm, heat, mechanics
        self.volumes, self.counters = dict(volumes), counters
        self._scheme, self._tolerance, self._most_passes = scheme, tolerance, most_passes
        heated = mechanics.bodies if mechanics and scheme in WITH_FEEDBACK else {}
        self._dissipation = Dissipation(comm, heated)
        self.interfaces = Interfaces(interfaces, scheme)
        self.interfaces.begin(self._resistances(self.interfaces.thermal()))
        self._thermal_change = ThermalChange(comm, heat, self.volumes, flowing(mechanics))
        # Nothing has moved yet, so that any step gives the stress of the initial state.
        self._update_bodies(self.interfaces.committed_step)

    @property
    def states(self) -> list[PairState]:
        """Trial states of the pairs of all interfaces, in the order of the heat problem."""
        return self.interfaces.states

    def _resistances(
        self, states: Sequence[PairState], factors: Sequence[FloatArray] | None = None
    ) -> list[FloatArray]:
        """Return the factors over h at the trial temperatures [m² K/W], one over h without."""
        found = self.heat.coefficients(states)
        scales = [np.ones(len(h)) for h in found] if factors is None else factors
        with np.errstate(divide="ignore"):
            return [np.asarray(scale / h) for scale, h in zip(scales, found, strict=True)]

    def advance(
        self,
        time: float,
        step: float,
        substeps: int,
        too_much: Callable[[StepChange], bool] = lambda change: False,
    ) -> StepChange:
        """Find the trial state at the end of a step that starts from the committed state.

        Args:
            time: start of the step [s].
            step: its size [s].
            substeps: steps of the heat problem inside it.
            too_much: tells of a change whether the step will be taken again, the same on all ranks.

        Raises:
            ConvergenceError: a problem or the passes did not converge; `rewind` then.
        """
        self._step = step
        guess = self.interfaces.first_guess(step)
        factors: list[FloatArray] = [np.ones(len(state.gap)) for state in guess]
        relaxation = Relaxation(self.comm)
        self.counters.begin_try()
        passes = Passes(self._tolerance, too_much)
        for _ in range(self._most_passes):
            temperature, at_rest = self._pass(time, step, substeps, guess, factors)
            thermal = self.interfaces.thermal()
            found = self._resistances(thermal)
            self.interfaces.resistances = found
            tried = _concatenated(self._resistances(guess, factors))
            apart = disagreement(self.comm, _concatenated(found), tried, self.interfaces.areas)
            of_heat = self._thermal_change.share(step * self._dissipation.update())
            passes.add(max(apart, of_heat), at_rest)
            skin = 0.0 if self.mechanics is None else self.mechanics.skin_growth()
            change = passes.changed(temperature, self._thermal_change, skin)
            if self._scheme != "iterated" or passes.agree:
                self._require_finite()
                return change
            if passes.go_round:
                break
            if (given_up := passes.given_up(change)) is not None:
                return given_up
            wanted = relaxation.next(tried, _concatenated(found))
            guess, factors = thermal, scaling(found, wanted)
        raise passes.failure()

    def step_errors(self) -> StepErrors:
        """Return the errors of the trial step; collective.

        A step lags by half of itself, and so are gaps and viscoplastic strains off by half of what
        they change in it.

        Raises:
            ConvergenceError: that of the temperatures cannot be found; on all ranks.
        """
        heat = self.heat.step_error(*self._heated_by)
        flow = 0.0 if self.mechanics is None else self.mechanics.largest_flow()
        moved = self.comm.allreduce(self.interfaces.largest_change(), op=MPI.MAX)
        return StepErrors(heat.uniform, 0.5 * moved, 0.5 * flow, heat.made, heat.substeps)

    def settle(self) -> None:
        """Bring bodies that are not free of stress at the start into equilibrium; collective.

        They are elastic for the moment, since no time passes. Where one of the bodies may be
        liquid, or no equilibrium is found, the first step does it.
        """
        if self.mechanics is None or not self._is_strained():
            return
        self._update_bodies(INSTANT)
        try:
            if not self.mechanics.equilibrium.solve(0.0).balanced:
                self.mechanics.equilibrium.finish(0.0)
        except ConvergenceError as error:
            log.debug("no equilibrium of the initial state: %s", error)
            self.rewind()
            return
        self.mechanics.equilibrium.commit()
        self.interfaces.update(self.mechanics.contact_states())
        self.interfaces.resistances = self._resistances(self.interfaces.thermal())
        self.interfaces.settle()

    def _is_strained(self) -> bool:
        """Return whether a body hinders its own thermal strain, and none may be liquid."""
        assert self.mechanics is not None
        bodies = self.mechanics.bodies.values()
        largest = max((np.abs(b.material.contracted).max(initial=0.0) for b in bodies), default=0.0)
        strained = self.comm.allreduce(float(largest), op=MPI.MAX) > SMALLEST_STRAIN
        return strained and all(body.is_compressible for body in bodies)

    def time_to_change(self, change: float) -> float:
        """Return the time in which the fastest node changes by a temperature; collective."""
        states = self.interfaces.thermal_at_start()
        return self.heat.time_to_change(change, list(zip(states, states, strict=True)))

    def _require_finite(self) -> None:
        moving = {} if self.mechanics is None else self.mechanics.bodies
        motions = {name: body.solution for name, body in moving.items()}
        require_finite(self.comm, {"temperature": self.heat.temperature, "motion": motions})

    def _pass(
        self,
        time: float,
        step: float,
        substeps: int,
        guess: Sequence[PairState],
        factors: Sequence[FloatArray],
    ) -> tuple[float, bool]:
        """Return the largest change of a temperature [K] in one pass, and whether forces rest."""
        self.counters.passes += 1
        at_rest = False
        both = list(zip(self.interfaces.thermal_at_start(), guess, strict=True))
        self._heated_by = both, factors
        report = self.heat.advance(time, step, both, substeps, self._dissipation.powers, factors)
        if self.mechanics is not None:
            self._update_bodies(step, passed=True)
            equilibrium = self.mechanics.equilibrium
            solved = equilibrium.solve(time + step)
            at_rest = solved.began_balanced
            if not solved.balanced:
                self.counters.unbalanced += 1
                equilibrium.finish(time + step)
            self.interfaces.update(self.mechanics.contact_states())
            self.counters.frozen_pairs = equilibrium.present.active.frozen_pairs()
            self.counters.fallbacks = equilibrium.fallbacks
        return report.largest_temperature_change, at_rest

    @booked_as(RunPart.ASSEMBLY)
    def _update_bodies(self, step: float, *, passed: bool = False) -> None:
        """Evaluate the laws at the trial temperatures, with what heat has passed or without."""
        if self.mechanics is not None:
            for name, body in self.mechanics.bodies.items():
                temperature = self.heat.temperature[name].x.array
                fraction = self.heat.solid_fraction[name].x.array
                between = self.heat.between(name) if passed and not body.is_compressible else ()
                body.update_state(temperature, fraction, step, between)

    def commit(self) -> None:
        """Accept the trial state as the start of the next step."""
        self.interfaces.commit(self._step)
        self.heat.commit()
        self._dissipation.commit()
        self._thermal_change.commit()
        if self.mechanics is not None:
            self.mechanics.equilibrium.commit()

    def rewind(self) -> None:
        """Return to the committed state."""
        self.interfaces.rewind()
        self.heat.rewind()
        self._dissipation.rewind()
        if self.mechanics is not None:
            for body in self.mechanics.bodies.values():
                body.rewind()  # a failed try leaves the liquid that it found trapped
        self._update_bodies(self.interfaces.committed_step)
        if self.mechanics is not None:
            self.mechanics.equilibrium.rewind()

    def saved(self) -> dict[str, Saved]:
        """Return the committed state as arrays; collective."""
        return saved_parts(self._parts())

    def _parts(self) -> dict[str, Stateful]:
        parts: dict[str, Stateful] = {
            "interfaces": self.interfaces, "heat": self.heat, "dissipation": self._dissipation
        }  # fmt: skip
        return parts if self.mechanics is None else parts | {"mechanics": self.mechanics.memory}

    def restore(self, arrays: Arrays) -> None:
        """Restore a state as the committed one; collective."""
        restore_parts(self._parts(), arrays)
        self.rewind()
        self._thermal_change.commit()

    def begin_stage(self, renewed: Collection[str]) -> None:
        """Start a stage with the committed state; collective.

        Args:
            renewed: names of the bodies that are new.
        """
        self.heat.begin_stage()
        if self.mechanics is not None:
            self.mechanics.memory.begin_stage(renewed)
        self.rewind()
        self._thermal_change.commit()

    def destroy(self) -> None:
        """Free the PETSc objects."""
        self.heat.destroy()
        if self.mechanics is not None:
            self.mechanics.destroy()


def _concatenated(parts: Sequence[FloatArray]) -> FloatArray:
    return np.concatenate([np.zeros(0), *parts])
