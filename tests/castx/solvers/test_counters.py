"""Counters of a step: which add up over tries and steps."""

from __future__ import annotations

import dataclasses

import pytest

from castx.errors import ConvergenceError
from castx.solvers.counters import StepCounters
from tests.coupled_cases import cylinder, merged, simulation

COUNTS = [f.name for f in dataclasses.fields(StepCounters) if f.name not in ("step", "wall")]
OF_THE_ACCEPTED_TRY = {"frozen_pairs", "unbalanced", "fallbacks"}


@pytest.mark.serial
def test_a_step_begins_with_nothing_counted():
    counters = StepCounters(step=1.0, wall=2.0, **dict.fromkeys(COUNTS, 3))
    counters.begin_step()
    assert counters == StepCounters()


@pytest.mark.serial
def test_a_try_forgets_only_what_qualifies_the_accepted_one():
    counters = StepCounters(step=1.0, **dict.fromkeys(COUNTS, 3))
    counters.begin_try()
    left = {name for name, count in counters.counts().items() if count == 3}
    assert left == set(COUNTS) - OF_THE_ACCEPTED_TRY and counters.step == 1.0
    assert set(counters.counts()) == set(COUNTS)


def test_heat_and_mechanics_count_the_solves_that_fail_as_well(comm):
    """One Newton iteration allowed: that one is spent before the step is given up."""
    data = cylinder({"solver": {"linear": "direct"}})
    for part, spent in (("heat", (1, 0)), ("mechanics", (None, 1))):
        run = simulation(comm, merged(data, {"solver": {part: {"snes_max_it": 1}}}))
        with pytest.raises(ConvergenceError):
            run.problem.advance(0.0, 1.0, 1)
        counters = run.problem.counters
        assert spent[0] is None or counters.heat_iterations == spent[0]
        assert (counters.mechanics_iterations, counters.passes) == (spent[1], 1)
        run.destroy()


def test_iterations_of_a_step_are_those_of_its_solves(comm):
    run = simulation(comm, cylinder({"solver": {"linear": "direct"}}))
    equilibrium, heat, reports = run.problem.mechanics.equilibrium, run.problem.heat, []
    solve, advance = equilibrium.solve, heat.advance
    equilibrium.solve = lambda time: reports.append(solve(time)) or reports[-1]
    heats = []
    heat.advance = lambda *given: heats.append(advance(*given)) or heats[-1]
    change = run.problem.advance(0.0, 0.05, 2)
    counters = run.problem.counters
    assert counters.passes == change.passes == len(reports) == len(heats)
    assert counters.heat_iterations == sum(report.iterations for report in heats) > 0
    assert counters.mechanics_iterations == sum(report.iterations for report in reports) > 0
    assert counters.linear_iterations == sum(report.linear_iterations for report in reports) > 0
    assert counters.contact_changes == sum(report.contact_changes for report in reports)
    run.destroy()
