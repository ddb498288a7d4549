"""When stages begin, cycle after cycle."""

import pytest

from castx.case.stages import Phase, Schedule, Stage

pytestmark = pytest.mark.serial


def stages(*described) -> list[Stage]:
    return [Stage.read(item) for item in described]


OPENING = {"at": "30 s", "remove": ["mould"]}
SPRAY = {"at": "40 s", "spray": {"on": ["casting"], "coefficient": 2000, "ambient": 20}}


def test_a_run_without_stages_has_one_phase():
    schedule = Schedule((), 90.0)
    assert schedule.phases == [Phase(0.0, 0, 1, 0.0)]
    assert (schedule.end, schedule.stops, schedule.stages) == (90.0, (), 1)


def test_stages_follow_each_other():
    schedule = Schedule(stages(OPENING, SPRAY), 90.0)
    assert [(p.start, p.stage) for p in schedule.phases] == [(0, 0), (30, 1), (40, 2)]
    assert (schedule.end, schedule.stops) == (90.0, (30.0, 40.0))
    assert [schedule.number_at(t) for t in (0.0, 29.9, 30.0, 39.0, 40.0, 90.0)] == [
        0, 0, 1, 1, 2, 2,
    ]  # fmt: skip


@pytest.mark.parametrize(("end", "ends"), [(60.0, 180.0), (600.0, 180.0), (150.0, 150.0)])
def test_a_stage_that_only_repeats_marks_the_end_of_the_cycle(end, ends):
    """The run ends with the last cycle, or where the case ends in the middle of one."""
    schedule = Schedule(stages(OPENING, {"at": "60 s", "repeat": 3, "renew": ["casting"]}), end)
    assert schedule.end == ends
    assert schedule.phases[:4] == [
        Phase(0.0, 0, 1, 0.0), Phase(30.0, 1, 1, 0.0), Phase(60.0, 0, 2, 60.0),
        Phase(90.0, 1, 2, 60.0),
    ]  # fmt: skip
    assert len(schedule.phases) == (6 if ends == 180.0 else 5)
    assert (schedule.stages, schedule.cycles, schedule.cycle_length) == (2, 3, 60.0)


def test_a_last_stage_that_acts_lasts_to_the_end_of_the_case():
    schedule = Schedule(stages({**OPENING, "repeat": 2, "renew": ["casting"]}), 50.0)
    assert [p.start for p in schedule.phases] == [0.0, 30.0, 50.0, 80.0]
    assert schedule.end == 100.0


def test_times_that_miss_a_stage_by_round_off_belong_to_it():
    schedule = Schedule(stages(OPENING, {"at": 60, "repeat": 3, "renew": ["casting"]}), 60.0)
    assert [schedule.number_at(90.0 * (1 + part)) for part in (-1e-12, 1e-12, -1e-6)] == [3, 3, 2]
