"""Moments of fields: events at the crossing of straight lines, given times without a cut step."""

import json

import pytest

from castx.results.field_times import FieldTimes
from castx.results.states.snapshot import FULLY_SOLID, ProcessState
from tests.castx.fakes import FakeSnapshot

pytestmark = pytest.mark.serial


def state(time, solid, gap=0.0, **process):
    totals = {
        "mould.solid_fraction": 1.0, "core.solid_fraction": 1.0, "part.solid_fraction": solid,
        "part/mould.max_gap": gap,
    }  # fmt: skip
    return FakeSnapshot(time, int(time > 0), None, totals=totals, process=ProcessState(**process))


def followed(every=None):
    times = FieldTimes(every, ["core", "part"])
    times.begin(state(0.0, 0.0))
    return times


def test_solid_fractions_are_met_within_steps_and_all_solid_at_the_end_of_one():
    times = followed()
    assert times.within(state(2.0, 0.1)) == []
    assert times.within(state(4.0, 0.6)) == pytest.approx([2.6, 3.6])  # 0.1 + 0.25 (t - 2)
    assert times.within(state(5.0, 0.75)) == [5.0]
    assert times.within(state(6.0, 0.95)) == [6.0]
    assert times.within(state(7.0, 0.999)) == []
    assert times.within(state(8.0, FULLY_SOLID)) == [8.0]
    assert times.within(state(9.0, 0.1)) == [] == times.within(state(10.0, 0.5)), "once each"


def test_the_first_gap_is_the_end_of_its_step():
    times = followed()
    found = [times.within(state(t, 0.1, gap)) for t, gap in ((1, 9e-7), (2, 2e-6), (3, 0), (4, 1))]
    assert found == [[], [2], [], []]


def test_given_times_lie_within_steps_however_long_these_are():
    times = followed(0.1)
    assert times.within(state(0.05, 0.0)) == []
    assert times.within(state(0.2, 0.0)) == pytest.approx([0.1, 0.2])
    assert times.within(state(0.1 + 0.2, 0.0)) == [0.1 + 0.2]
    assert times.within(state(0.6 - 1e-16, 0.5)) == pytest.approx([0.4, 0.45, 0.5, 0.6])


def test_the_first_step_of_a_stage_has_its_end_alone():
    """What the bodies were at its beginning is not known: one may be gone, another one new."""
    times = followed(1.0)
    times.within(state(1.0, 0.1))
    assert times.within(state(3.5, 0.3, stage=1)) == [3.5]
    assert times.within(state(4.5, 0.4, stage=1)) == [4.0]
    assert times.within(state(5.5, 0.4, stage=0, cycle=2)) == [5.5]
    assert times.within(state(5.9, 0.9, stage=0, cycle=2)) == [], "events are of the first cycle"


def test_a_run_that_goes_on_meets_the_events_that_are_left():
    times = followed(5.0)
    times.within(state(3.0, 0.3, 2e-6))
    notes = json.loads(json.dumps(times.notes()))
    later = FieldTimes(5.0, ["core", "part"])
    later.resume(notes, state(3.0, 0.3, 2e-6))
    for each in (times, later):
        assert each.within(state(6.0, 0.6, 3e-6)) == pytest.approx([5.0])  # 0.5 then as well
        assert each.within(state(7.0, 0.2, 3e-6)) == [] == each.within(state(8.0, 0.3, 3e-6))


def test_nothing_happens_where_nothing_freezes():
    times = FieldTimes(None, ["core"])
    times.begin(state(0.0, 0.0))
    assert times.within(state(2.0, 1.0)) == []
