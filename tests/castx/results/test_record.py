"""run.json: sums over steps, restarts, and how a run ended."""

from __future__ import annotations

import json
import math

import pytest

from castx.results.files.reason import Reason
from castx.results.record import RunRecord, number, peak_memory
from castx.solvers.counters import StepCounters
from tests.castx.fakes import FakeSnapshot, cylinder_mesh


def record_after(mesh, path, steps: int, first: int = 0) -> RunRecord:
    record = RunRecord(path, {"case": {"name": "test"}})
    add_steps(record, mesh, steps, first)
    return record


def add_steps(record, mesh, steps: int, first: int) -> None:
    for step in range(first, first + steps):
        counters = StepCounters(
            step=0.5, wall=2.0, heat_iterations=3, passes=2, cutbacks=step, fallbacks=1
        )
        totals = {"energy_error": math.nan, "support_force": 1.5 * step}
        record.update(FakeSnapshot(0.5 * step, step, mesh, totals=totals, counters=counters))


def written(record: RunRecord, reason=Reason.FINISHED, message="") -> dict:
    record.write(reason, message)
    return json.loads(record.path.read_text())


@pytest.mark.serial
def test_hot_spots_stand_in_the_record(comm, tmp_path):
    record = record_after(cylinder_mesh(comm), tmp_path / "run.json", 1)
    assert written(record)["hot_spots"] == []
    record.note_hot_spots([{"body": "casting", "pool": 2, "deficit": 1e-7}])
    assert written(record)["hot_spots"] == [{"body": "casting", "pool": 2, "deficit": 1e-7}]


@pytest.mark.serial
def test_counters_add_up_over_the_steps_but_not_the_initial_state(comm, tmp_path):
    content = written(record_after(cylinder_mesh(comm), tmp_path / "run.json", 4))
    expected = StepCounters(heat_iterations=9, passes=6, cutbacks=6, fallbacks=3).counts()
    assert content["totals"] == {"steps": 3, **expected}
    assert content["time_reached"] == 1.5
    assert content["last"] == {"energy_error": None, "support_force": 4.5}
    assert content["case"] == {"name": "test"} and content["restarts"] == []


@pytest.mark.serial
def test_a_restarted_run_counts_on(comm, tmp_path):
    mesh = cylinder_mesh(comm)
    first = record_after(mesh, tmp_path / "run.json", 3)
    notes = json.loads(json.dumps(first.notes()))
    second = RunRecord(tmp_path / "run.json", {})
    second.resume(notes)
    add_steps(second, mesh, 2, 3)
    content = written(second)
    whole = written(record_after(mesh, tmp_path / "whole.json", 5))
    assert content["totals"] == whole["totals"] and content["time_reached"] == 2.0
    assert content["started"] == notes["started"] and content["wall"] >= notes["wall"]
    assert [restart["at"] for restart in content["restarts"]] == [1.0]


@pytest.mark.serial
def test_the_record_says_why_a_run_ended(tmp_path):
    content = written(RunRecord(tmp_path / "run.json", {}), Reason.FAILED, "full")
    assert content["exit"] == {"reason": "failed", "message": "full"}


@pytest.mark.serial
def test_json_has_no_number_that_it_does_not_know():
    assert [number(value) for value in (1.5, math.nan, math.inf, -math.inf)] == [1.5, *[None] * 3]


@pytest.mark.ranks
def test_memory_is_that_of_the_largest_rank_and_of_all(comm):
    found = peak_memory(comm)
    assert 1e7 < found["largest_rank"] <= found["all_ranks"] <= comm.size * found["largest_rank"]
