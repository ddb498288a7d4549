"""The loop over time, as an iterator over accepted steps."""

from __future__ import annotations

import logging
import time as clock
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import ceil, inf
from typing import Any, Self

from mpi4py import MPI

import numpy as np

from castx.case.case import Case
from castx.coupling.change import StepChange
from castx.coupling.step import CoupledProblem
from castx.domain.memory import refuse_too_large
from castx.domain.mesh import build_mesh
from castx.domain.pairs.pairing import case_pairs
from castx.errors import ConvergenceError
from castx.process.building import first_change, process_of, step_settings
from castx.process.process import Process
from castx.process.state import State
from castx.process.step_control import MOST_SUBSTEPS, SAFETY, StepControl, StepSettings
from castx.profiling import RunPart, booked_as
from castx.ranks import end_unless_all_failed
from castx.solvers.counters import StepCounters
from castx.solvers.diagnosis import FailedTry, diagnosis
from castx.stateful import (
    Arrays,
    Saved,
    Stateful,
    joined,
    number,
    part_of,
    restore_parts,
    saved_parts,
)
from castx.transfer.conductance import ConductionLaw

EASY_PASSES = 10
"""Passes of a step, until it had settled, above which the next one does not grow."""

CHANGE_PER_SUBSTEP = 0.25
"""Share of the wanted temperature change that one heat sub-step aims at."""

SOLID_PER_SUBSTEP = 0.1
"""Solid fraction that a heat sub-step aims to add to the fastest node: a front passes no more of an
element, while temperatures hardly change on either side of it."""

WARMEST = 20.0
"""Change of temperature in a step that sub-steps divide, where none smaller is wanted [K]."""

ERRORS = {"temperature_error": "made", "gap_error": "gap", "strain_error": "strain"}
"""Columns of history.csv with the errors by the steps, and what they are in `StepErrors`."""

NO_COUNTERS = StepCounters()

_log = logging.getLogger(__name__)


class Simulation:
    """A case on its mesh, stepped from the end of filling to the end of the run.

    >>> from mpi4py import MPI
    >>> import castx
    >>> case = castx.load_case("cylinder.toml", ["time.end=0.1", "geometry.size=1e-2"])
    >>> simulation = castx.Simulation.from_case(case, MPI.COMM_SELF)
    >>> for state in simulation:
    ...     centre = state.nodal("casting", "temperature").max()
    ...     print(f"step {state.step} at {state.time:g} s: {centre:.1f} °C")
    step 0 at 0 s: 670.0 °C
    step 1 at 0.05 s: 670.0 °C
    step 2 at 0.1 s: 670.0 °C

    Attributes:
        mesh: all bodies.
        pairs: all node pairs by the name of the interface.
        process: stages and what is solved during the present one.

    Args:
        process: the process at its start.
        settings: of the step control.
        substeps: heat steps inside one mechanical step; None: by the temperature change.
        comm: ranks of which none is left waiting for one that fails; None: it is alone.
    """

    def __init__(
        self,
        process: Process,
        settings: StepSettings,
        substeps: int | None = None,
        comm: MPI.Intracomm | None = None,
    ) -> None:
        self.process = process
        self.mesh, self.pairs = process.now.mesh, process.now.pairs
        self.control = StepControl(settings)
        self._wanted, self._substeps = min(settings.temperature_change, WARMEST), substeps
        self._bounds = settings.tolerance
        self._errors = {} if settings.tolerance is None else dict.fromkeys(ERRORS, 0.0)
        self._substep_rate = np.inf
        self._verdicts = None if comm is None else comm.Dup()
        self._begun = False
        self.time = 0.0
        self.step = 0

    @classmethod
    @booked_as(RunPart.START)
    def from_case(
        cls, case: Case, comm: MPI.Intracomm, laws: Mapping[str, ConductionLaw] | None = None
    ) -> Self:
        """Build the mesh and the problems of a case.

        Args:
            case: the case.
            comm: the ranks to run on.
            laws: heat transfer of interfaces by their names, in place of that of the case, such
                as `castx.transfer.user_law.UserLaw`; radiation stays as the case has it.

        Raises:
            CaseError: the case cannot be solved as described.
            MeshError: the mesh does not hold what the case asks of it.
        """
        names = [body.name for body in case.bodies]
        refuse_too_large(case.geometry, names, comm, solved=True)
        mesh = build_mesh(case.geometry, names, comm)
        pairs = case_pairs(mesh, case.interfaces)
        process = process_of(case, mesh, pairs, laws)
        given = case.time.heat_substeps
        substeps = None if isinstance(given, str) else given
        fastest = inf
        if case.time.first_step is None:
            fastest = process.now.problem.time_to_change(first_change(case.time))
        return cls(process, step_settings(case, fastest), substeps, comm)

    @property
    def problem(self) -> CoupledProblem:
        """Heat and mechanics of the present stage."""
        return self.process.now.problem

    def __iter__(self) -> Iterator[State]:
        """Yield the states, see `states`."""
        return self.states()

    def states(self, after_failed_try: Callable[[], None] = lambda: None) -> Iterator[State]:
        """Yield the initial state unless that is done, then the state after each accepted step.

        Args:
            after_failed_try: called when a try has failed or changed too much, and is rewound.

        Raises:
            ConvergenceError: even the smallest step fails; the last state yielded is the last one
                accepted.
        """
        try:
            yield from self._states(after_failed_try)
        except (Exception, SystemExit) as error:
            # A driver that ends on this rank alone would leave the others waiting for ever.
            why = "".join(traceback.format_exception(error)).rstrip()
            if self._verdicts is not None:
                end_unless_all_failed(self._verdicts, f"\n{why}")
            raise

    def _states(self, after_failed_try: Callable[[], None]) -> Iterator[State]:
        if not self._begun:
            self._begun = True
            self.problem.settle()
            yield self.state()
        while not self.is_finished:
            if self.process.proceed(self.time, lambda: self.state().totals):
                self.control.restart()
                self._substep_rate = np.inf
            yield self.state(self._advance(after_failed_try))

    @property
    def end(self) -> float:
        """End of the run, all cycles included [s]."""
        return self.process.schedule.end

    @property
    def is_finished(self) -> bool:
        """Whether the end of the run is reached."""
        return self.control.finished(self.time)

    def _advance(self, after_failed_try: Callable[[], None]) -> StepCounters:
        """Advance by one step, reduced as long as it fails or its changes are too large."""
        begin = clock.perf_counter()
        failed: list[FailedTry] = []
        self.problem.counters.begin_step()
        within = self.time - self.process.phase.cycle_start
        while True:
            step = self.control.propose(self.time)
            _log.debug("step of %g s from %g s", step, self.time)
            try:
                change = self._try(within, step)
            except ConvergenceError as error:
                _log.debug("the step failed: %s", error)
                self.problem.rewind()
                failed.append(FailedTry(step, error))
                self.problem.counters.cutbacks += 1
                self._cut(failed)
                after_failed_try()
                continue
            if not self.control.exceeds(step, change):
                break
            _log.debug(
                "it changed too much: %g K, %g of a body froze, %g of a skin began to bear, %s",
                change.temperature, change.mean_solid_fraction, change.skin, change.errors,
            )  # fmt: skip
            self.problem.rewind()
            self._substep_rate = max(self._substep_rate, self._wanted_substeps(change) / step)
            self.problem.counters.repeats += 1
            after_failed_try()
        counters = self.problem.counters
        self.problem.commit()
        easy = change.settled <= EASY_PASSES
        self.control.accept(step, change, easy)
        self._substep_rate = self._wanted_substeps(change) / step
        self._errors = {name: getattr(change.errors, ERRORS[name]) for name in self._errors}
        self.time = self.control.landed(self.time + step)
        self.step += 1
        self.process.end_step(self.time)
        return replace(counters, step=step, wall=clock.perf_counter() - begin)

    def _try(self, time: float, step: float) -> StepChange:
        """Try a step from a time of the cycle, and estimate its errors if they are asked for."""
        too_much = partial(self.control.is_too_much, step)
        change = self.problem.advance(time, step, self._heat_substeps(step), too_much)
        if not self._errors or not change.agreed:
            return change
        return replace(change, errors=self.problem.step_errors())

    def _cut(self, failed: Sequence[FailedTry]) -> None:
        """Make the next try smaller than the last one, or give up and say why."""
        last = failed[-1]
        try:
            self.control.reject(last.step, last.error)
        except ConvergenceError as error:
            text = f"{error}\n{diagnosis(self.time, failed)}"
            raise ConvergenceError(text, last.error.problem) from last.error

    def _wanted_substeps(self, change: StepChange) -> float:
        """Return the heat steps that a step like the last one should have."""
        if self._bounds is not None and self._bounds.temperature < np.inf:
            errors = change.errors
            return errors.substeps * errors.temperature / (SAFETY * self._bounds.temperature)
        by_temperature = change.temperature / (CHANGE_PER_SUBSTEP * self._wanted)
        return max(by_temperature, change.solid_fraction / SOLID_PER_SUBSTEP)

    def _heat_substeps(self, step: float) -> int:
        """Return the heat steps inside a step: the faster the state changes, the more."""
        if self._substeps is not None:
            return self._substeps
        most = MOST_SUBSTEPS if self._bounds is None else self._bounds.substeps
        expected = min(self._substep_rate * step, most)
        return max(ceil(expected), 1)

    def state(self, counters: StepCounters = NO_COUNTERS) -> State:
        """Return the state after the last accepted step."""
        process = self.process
        return State(
            process.now, self.time, self.step, counters, process.state(), process.left,
            process.friction, self._errors,
        )  # fmt: skip

    def saved(self) -> dict[str, Saved]:
        """Return the state after the last accepted step as arrays; collective."""
        clock = {
            "time": number(self.time),
            "step": number(self.step),
            "substep_rate": number(self._substep_rate),
        }
        return joined({"clock": clock}) | saved_parts(self._parts())

    def _parts(self) -> dict[str, Stateful]:
        return {"process": self.process, "control": self.control}

    def notes(self) -> dict[str, Any]:
        """Return the stage and the events for the header of a checkpoint, as JSON knows them."""
        return self.process.notes()

    def prepare(self, notes: Mapping[str, Any]) -> None:
        """Go to the stage of `notes`, so that `saved` has the names of its arrays; collective."""
        self.process.prepare(notes)

    def restore(self, arrays: Arrays) -> None:
        """Restore a saved state; the next state yielded belongs to the step after it."""
        clock = part_of(arrays, "clock")
        self.time, self.step = float(clock["time"]), int(clock["step"])
        self._substep_rate = float(clock["substep_rate"])
        restore_parts(self._parts(), arrays)
        self._begun = True

    def destroy(self) -> None:
        """Free the PETSc objects."""
        self.process.destroy()
        if self._verdicts is not None:
            self._verdicts.Free()
            self._verdicts = None
