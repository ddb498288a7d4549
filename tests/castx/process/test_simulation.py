"""The loop over time: cutbacks, what is left after a failure, output times, heat sub-steps."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.case.stages import Schedule
from castx.coupling.change import StepChange, StepErrors
from castx.coupling.step import CoupledProblem
from castx.errors import ConvergenceError
from castx.process.building import step_settings
from castx.process.process import Process, StageProblem
from castx.process.simulation import Simulation
from castx.process.step_control import (
    MOST_SUBSTEPS,
    SAFETY,
    ErrorBounds,
    StepControl,
    StepSettings,
)
from castx.solvers.counters import StepCounters
from tests import coupled_cases
from tests.coupled_cases import TIGHT, cylinder, merged

SETTINGS = StepSettings(10.0, 1.0, 4.0, 0.1, 20.0)


class FakeProblem:
    """Fails for steps above a limit and counts what it is asked."""

    def __init__(self, limit: float = np.inf, change: float = 10.0, solid: float = 0.0) -> None:
        self.limit, self.change, self.solid = limit, change, solid
        self.tried: list[tuple[float, float, int]] = []
        self.committed: list[float] = []
        self.rewinds, self.counters, self.frozen = 0, StepCounters(), 0.0

    def advance(self, time: float, step: float, substeps: int, too_much: object) -> StepChange:
        self.tried.append((time, step, substeps))
        self.counters.passes += 3
        self.counters.heat_iterations += 7
        if step > self.limit:
            raise ConvergenceError("too large for this problem")
        return StepChange(3, self.change * step, self.solid * step, self.frozen * step)

    def step_errors(self) -> StepErrors:
        """Return errors that grow with the heat steps and the steps."""
        _, step, substeps = self.tried[-1]
        return StepErrors(2.0 * step / substeps, 1e-6 * step, 1e-5 * step, 3.0, substeps)

    def settle(self) -> None:
        assert not self.tried

    def commit(self) -> None:
        time, step, _ = self.tried[-1]
        self.committed.append(time + step)

    def rewind(self) -> None:
        self.rewinds += 1


def simulation(problem: Any, substeps: int | None = None, **changes) -> Simulation:
    settings = StepSettings(**{**SETTINGS.__dict__, **changes})
    no_mesh: Any = None
    stage = StageProblem(no_mesh, {}, problem)
    return Simulation(Process(Schedule((), settings.end), lambda _: stage), settings, substeps)


def test_states_are_those_accepted():
    problem = FakeProblem()
    seen = [(s.time, s.step, s.counters.passes) for s in simulation(problem)]
    assert seen[0] == (0.0, 0, 0)
    assert [s[0] for s in seen[1:]] == problem.committed
    assert [s[1] for s in seen] == list(range(len(seen)))
    assert {s[2] for s in seen[1:]} == {3}
    assert seen[-1][0] == pytest.approx(10.0)
    assert problem.rewinds == 0


def test_cutback():
    problem = FakeProblem(limit=0.3)
    states = list(simulation(problem))
    first = states[1]
    assert first.counters.cutbacks == 2
    assert first.counters.step == pytest.approx(0.25)
    assert problem.rewinds == len(problem.tried) - len(problem.committed)
    assert sum(s.counters.cutbacks for s in states) == problem.rewinds
    assert states[-1].time == pytest.approx(10.0)


@pytest.mark.parametrize(("change", "frozen"), [(60.0, 0.0), (0.0, 0.15)])
def test_a_step_that_changes_too_much_is_taken_again(change, frozen):
    """From 2 s on 60 K or 15 % solid per second: steps stay below 1.5 times of 20 K or 5 %."""
    problem, states = FakeProblem(change=1.0), []
    for state in simulation(problem, first=0.25, reject_above=1.5, solid_fraction_change=0.05):
        states.append(state)
        if state.time >= 2.0:
            problem.change, problem.frozen = change, frozen
    late = [s.counters for s in states if s.time - s.counters.step >= 2.0]
    assert problem.rewinds == len(problem.tried) - len(problem.committed) > 0
    assert all(counters.cutbacks == 0 for counters in late), "nothing failed"
    assert sum(counters.repeats for counters in late) == problem.rewinds
    assert all(counters.passes == 3 * (1 + counters.repeats) for counters in late)
    assert max(counters.step for counters in late) <= 0.5
    assert states[-1].time == pytest.approx(10.0)


def test_fixed_steps_are_not_taken_again():
    problem = FakeProblem(change=1e3)
    steps = [state.counters.step for state in simulation(problem, fixed=2.0, reject_above=1.0)]
    assert steps[1:] == [2.0] * 5 and problem.rewinds == 0


def test_steps_follow_their_tolerance():
    """Errors of 2 K, 1 µm and 1e-5 for each second."""
    for bounds, largest in (
        (ErrorBounds(temperature=0.5), 0.25 * SAFETY),
        (ErrorBounds(gap=5e-7), 0.5 * SAFETY),
        (ErrorBounds(strain=4e-6), 0.4 * SAFETY),
        (ErrorBounds(temperature=0.5, gap=5e-7, substeps=4), 0.5 * SAFETY),
    ):
        problem = FakeProblem(change=1e-3)
        settings = {"tolerance": bounds, "reject_above": 1.2, "smallest": 1e-3}
        states = list(simulation(problem, temperature_change=np.inf, **settings))
        steps = [state.counters.step for state in states[1:-2]]
        assert steps[-1] == pytest.approx(largest), bounds
        assert states[1].counters.repeats > 0
        assert problem.tried[-3][2] == (2 if bounds.substeps == 4 else 1)


def test_errors_are_columns_of_a_run_with_a_tolerance():
    bounded = simulation(FakeProblem(change=1e-3), tolerance=ErrorBounds(gap=1e-3))
    errors = [state.errors for state in bounded]
    assert errors[0] == {"temperature_error": 0.0, "gap_error": 0.0, "strain_error": 0.0}
    assert errors[1] == {"temperature_error": 3.0, "gap_error": 1e-6, "strain_error": 1e-5}

    class Unasked(FakeProblem):
        def step_errors(self):
            raise AssertionError("nobody asked for errors")

    assert all(not state.errors for state in simulation(Unasked()))


class GivenSteps(StepControl):
    """Takes the steps that it is given."""

    def __init__(self, settings: StepSettings, steps: list[float]) -> None:
        super().__init__(settings)
        self._steps = iter(steps)

    def propose(self, time: float) -> float:
        return next(self._steps)

    def exceeds(self, step: float, change: StepChange) -> bool:
        return False


@pytest.mark.parametrize(
    "wanted",
    [
        {"solid_fraction_change": 0.004},
        {"tolerance": {"temperature": 6.0, "gap": 4e-6}, "heat_substeps": 2},
    ],
)
def test_a_try_that_changed_too_much_leaves_no_trace(comm, wanted):
    """The steps that were accepted, taken at once, end in the same state."""
    changes = {"time": {"end": 3.0, "first_step": 0.05, "largest_step": 4.0}} | TIGHT
    data = cylinder(changes, {"time": {"reject_above": 1.0, **wanted}})
    data["bodies"][0]["law"] = "thermo-elasto-plastic"
    data["materials"]["aluminium"] |= {
        "yield_stress": 3e7, "liquid": {"viscosity": 1e5, "coherency": 0.5},
    }  # fmt: skip
    taken = list(coupled_cases.simulation(comm, data))
    assert sum(state.counters.repeats for state in taken) >= 1
    found = coupled_cases.fields(taken[-1])
    again = coupled_cases.simulation(comm, data)
    steps = [state.counters.step for state in taken[1:]]
    again.control = GivenSteps(step_settings(read_case(data, Path("case.toml"))), steps)
    state = list(again)[-1]
    assert state.time == taken[-1].time
    for name, value in coupled_cases.fields(state).items():
        scale = comm.allreduce(np.abs(value).max(initial=0.0), max)
        np.testing.assert_allclose(value, found[name], rtol=0.0, atol=1e-9 * scale, err_msg=name)


@pytest.mark.ranks
def test_a_run_with_a_tolerance_goes_on_from_a_saved_state(comm):
    """To the bit: steps, errors, and what they end in; on several ranks sums vary in order."""
    tolerance = {"temperature": 6.0, "gap": 4e-6, "strain": 1e-4}
    data = cylinder({"time": {"end": 2.0, "tolerance": tolerance}})
    whole, saved = coupled_cases.simulation(comm, data), {}
    for state in whole:
        if state.step == 6:
            saved = {name: item.values.copy() for name, item in whole.saved().items()}
    ended = coupled_cases.fields(state), dict(state.errors), state.step
    later = coupled_cases.simulation(comm, data)
    later.restore(saved)
    state = list(later)[-1]
    vary = 0.0 if comm.size == 1 else 1e-10
    assert dict(state.errors) == pytest.approx(ended[1], rel=vary, abs=0.0)
    assert state.step == ended[2]
    assert state.errors["temperature_error"] > 0.0
    scales: dict[str, float] = {}
    for name, value in ended[0].items():
        kind = name.split()[-1]  # the hot casting moves by nothing, the mould by micrometres
        scales[kind] = max(
            scales.get(kind, 0.0), comm.allreduce(np.abs(value).max(initial=0.0), max)
        )
    for name, value in coupled_cases.fields(state).items():
        scale = scales[name.split()[-1]]
        np.testing.assert_allclose(value, ended[0][name], 0.0, vary * scale, err_msg=name)
    whole.destroy()
    later.destroy()


def test_counters_include_the_rejected_tries():
    """Three tries of the first step, each of three passes; later steps count their own."""
    counters = [state.counters for state in simulation(FakeProblem(limit=0.3))]
    assert counters[0] == StepCounters()
    assert (counters[1].passes, counters[1].heat_iterations) == (9, 21)
    for later in counters[1:]:
        assert later.passes == 3 * (1 + later.cutbacks)
        assert later.heat_iterations == 7 * (1 + later.cutbacks)


def test_each_try_starts_at_the_accepted_time():
    problem = FakeProblem(limit=0.7)
    list(simulation(problem))
    accepted = [0.0, *problem.committed]
    assert all(any(time == t for t in accepted) for time, _, _ in problem.tried)


def test_gives_up_at_the_smallest_step():
    problem, seen = FakeProblem(limit=0.05), []
    run = simulation(problem)
    with pytest.raises(ConvergenceError, match=r"0\.1 s.*too large for this problem"):
        seen.extend(run)
    assert len(seen) == 1
    assert problem.committed == []
    assert problem.rewinds == len(problem.tried)
    assert (run.time, run.step) == (0.0, 0)


def test_substeps_follow_the_temperature():
    problem = FakeProblem(change=9.0)
    list(simulation(problem, fixed=2.0))
    assert [n for _, _, n in problem.tried] == [MOST_SUBSTEPS] + [4] * 4  # 18 K in steps of 5 K


def test_substeps_follow_the_front():
    problem = FakeProblem(change=0.0, solid=0.17)
    list(simulation(problem, fixed=2.0))
    assert [n for _, _, n in problem.tried] == [MOST_SUBSTEPS] + [4] * 4  # 0.34 in steps of 0.1


def test_substeps_have_a_bound():
    problem = FakeProblem(change=1e3)
    list(simulation(problem, fixed=2.0))
    assert {n for _, _, n in problem.tried} == {MOST_SUBSTEPS}


def test_given_substeps():
    problem = FakeProblem(change=1e3)
    list(simulation(problem, substeps=3, fixed=2.0))
    assert {n for _, _, n in problem.tried} == {3}


def test_output_times_cut_no_steps(comm):
    short = {"time": {"end": 3.0}}
    times = [
        [state.time for state in coupled_cases.states(comm, cylinder(short | output))]
        for output in ({}, {"output": {"every": 0.03}})
    ]
    assert times[0] == times[1]


@pytest.mark.sampled
@pytest.mark.parametrize(
    "cause", [{"coupling": {"passes": 2}}, {"solver": {"heat": {"snes_max_it": 2}}}]
)
def test_failed_steps_of_a_case_are_cut_and_the_run_completes(comm, cause):
    """Too few passes or iterations for the large first step: smaller steps need less."""
    easy = cylinder({"time": {"end": 4.0, "first_step": 2.0, "heat_substeps": 4}})
    easy["interfaces"][0]["heat"]["gas_conductivity"] = 0.005
    hard = coupled_cases.states(comm, merged(easy, cause))
    cutbacks, state = 0, None
    for state in hard:
        cutbacks += state.counters.cutbacks
        assert state.totals["energy_error"] < 1e-6
    assert cutbacks > 0
    assert state.time == pytest.approx(4.0)
    whole = coupled_cases.final_state(comm, easy)
    for name in ("casting", "mould"):
        assert state.totals[f"{name}.enthalpy"] == pytest.approx(
            whole.totals[f"{name}.enthalpy"], rel=0.02
        )


def test_last_accepted_state_survives_the_end(comm):
    """When even the smallest step fails, the last state yielded still shows what it showed."""
    data = cylinder({"time": {"end": 4.0, "first_step": 1.0, "smallest_step": 0.5}})
    run = coupled_cases.simulation(comm, data)
    shown, state = None, None
    with pytest.raises(ConvergenceError, match=r"smallest step of 0\.5 s"):
        for state in run:
            shown = coupled_cases.fields(state)
            if state.step == 1:
                run.problem.__class__ = Failing
    assert state.step == 1
    again = coupled_cases.fields(state)
    for name, value in shown.items():
        assert np.array_equal(value, again[name]), name


class Failing(CoupledProblem):
    """Solves the step and then says that it failed."""

    def advance(self, time, step, substeps, too_much):
        super().advance(time, step, substeps, too_much)
        raise ConvergenceError("on purpose")


@pytest.mark.ranks
def test_heat_is_kept_where_the_wall_of_an_alloy_takes_the_temperature_of_its_mould(comm):
    """It was 0.07 short in iron whose latent heat was found inside cells."""
    data = cylinder({"time": {"end": 0.1, "fixed_step": 0.05}})
    data["interfaces"][0]["heat"] = {"law": "perfect"}
    data["bodies"][0] |= {"material": "AlSi7Mg", "temperature": 640.0}
    for state in coupled_cases.states(comm, data):
        assert state.totals["casting.solid_fraction"] > 0.1
        assert state.totals["energy_error"] < 1e-7
