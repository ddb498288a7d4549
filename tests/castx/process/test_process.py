"""A process goes from stage to stage: what it keeps, leaves behind and takes back."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from castx.case.stages import Schedule, Stage
from castx.errors import CaseError
from castx.process.process import Cycling, Process, StageProblem
from castx.stateful import Numbering, Saved, number

pytestmark = pytest.mark.serial

INITIAL = {"casting": 700.0, "mould": 200.0}


class FakeProblem:
    """A number for each body, and one for the whole run."""

    def __init__(self, bodies):
        self.values = {name: INITIAL[name] for name in bodies}
        self.run, self.renewed, self.destroyed = 0.0, None, False
        self.heat = SimpleNamespace(temperature={})

    def saved(self) -> dict[str, Saved]:
        found = {
            name: Saved(np.array([value]), Numbering(name, np.zeros(1, dtype=int), 1, (name,)))
            for name, value in self.values.items()
        }
        return {**found, "run": number(self.run), "time": number(1.0, of_cycle=True)}

    def restore(self, arrays) -> None:
        self.values = {name: float(arrays[name][0]) for name in self.values}
        self.run = float(arrays["run"])

    def begin_stage(self, renewed) -> None:
        self.renewed = set(renewed)

    def destroy(self) -> None:
        self.destroyed = True


class FakeEnds:
    """Compares nothing."""

    def __init__(self) -> None:
        self.notes = 0

    def note(self, temperature) -> None:
        self.notes += 1

    def change(self) -> float | None:
        return 3.0

    def saved(self) -> dict[str, Saved]:
        return {"notes": number(self.notes)}

    def restore(self, arrays) -> None:
        self.notes = int(arrays["notes"])


def build(stage: int) -> StageProblem:
    """Return all bodies at the start, the casting alone during the stage."""
    bodies = ["casting", "mould"] if stage == 0 else ["casting"]
    mesh = SimpleNamespace(bodies=dict.fromkeys(bodies))
    return StageProblem(mesh, {}, FakeProblem(bodies))  # type: ignore[arg-type]


def process(repeat: int = 1) -> Process:
    """Return a process that removes the mould at 3 s; cycles last 4 s and renew the casting."""
    stages = [Stage.read({"at": 3.0, "remove": ["mould"]})]
    if repeat == 1:
        return Process(Schedule(stages, 5.0), build, [{}, {}])
    stages.append(Stage.read({"at": 4.0, "repeat": repeat, "renew": ["casting"]}))
    cycling = Cycling(FakeEnds(), ["casting"], 1.0)  # type: ignore[arg-type]
    return Process(Schedule(stages, 4.0), build, [{}, {}, {}], cycling)


TOTALS = {
    "casting.solid_fraction": 1.0, "mould.solid_fraction": 1.0, "mould.heat_in": 9.0,
    "casting/mould.force.z": 5.0,
}  # fmt: skip


def test_a_stage_goes_on_with_the_bodies_that_stay():
    run = process()
    first = run.now.problem
    first.values.update(casting=500.0, mould=300.0)
    first.run = 7.0
    assert not run.proceed(2.0, lambda: TOTALS) and run.now.problem is first
    assert run.proceed(3.0, lambda: TOTALS)
    assert first.destroyed and run.phase.stage == 1
    assert run.now.problem.values == {"casting": 500.0} and run.now.problem.run == 7.0
    assert run.now.problem.renewed == set()
    assert run.left["mould.heat_in"] == 9.0 and run.left["casting/mould.force.z"] == 0.0
    (event,) = run.state().events
    assert event["bodies"] == ["casting"] and event["removed"] == {"mould": 1.0}


def test_a_cycle_renews_what_it_names_and_takes_back_what_was_set_aside():
    run = process(repeat=2)
    run.now.problem.values.update(casting=500.0, mould=300.0)
    run.proceed(3.0, lambda: TOTALS)
    run.now.problem.values["casting"] = 400.0
    assert run.proceed(4.0, lambda: TOTALS)
    assert run.now.problem.values == {"casting": 700.0, "mould": 300.0}
    assert run.now.problem.renewed == {"casting"} == set(run.state().renewed)
    assert (run.state().cycle, run.state().cycle_start) == (2, 4.0)
    assert not run.proceed(4.5, lambda: TOTALS)
    assert run.state().renewed == frozenset()


def test_the_end_of_a_cycle_is_compared_once():
    run = process(repeat=2)
    for time in (1.0, 3.0):
        run.end_step(time)
    run.proceed(3.0, lambda: TOTALS)
    run.end_step(3.5)
    assert run.state().cycles_ended == 0
    run.end_step(4.0)
    assert run.state().cycles_ended == 1 == run.state().cycle
    changes = [event["change"] for event in run.state().events if "change" in event]
    assert changes == [3.0]


def test_a_process_is_restored_in_its_stage_with_what_was_set_aside():
    run, again = process(repeat=2), process(repeat=2)
    run.now.problem.values.update(casting=500.0, mould=300.0)
    run.proceed(3.0, lambda: TOTALS)
    again.prepare(run.notes())
    assert set(again.saved()) == set(run.saved())
    again.restore({name: saved.values for name, saved in run.saved().items()})
    assert again.now.problem.values == {"casting": 500.0} and again.left == run.left
    assert again.state().events == run.state().events
    for one in (run, again):
        one.proceed(4.0, lambda: TOTALS)
    assert again.now.problem.values == run.now.problem.values == {"casting": 700.0, "mould": 300.0}


def test_a_checkpoint_of_other_stages_is_refused():
    run = process()
    run.proceed(3.0, lambda: TOTALS)
    with pytest.raises(CaseError, match=r"its stage began at 3\.5 s"):
        process().prepare({**run.notes(), "start": 3.5})


def test_the_friction_of_a_body_is_that_of_its_first_stage():
    ejected = [{}, {"core": 0.2}, {"core": 0.9, "casting": 0.3}]
    run = Process(Schedule((), 5.0), build, ejected)
    assert run.friction == {"core": 0.2, "casting": 0.3}
