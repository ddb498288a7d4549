"""Events of a process as results and log have them."""

from __future__ import annotations

import json
import logging

import pytest

from castx.case.stages import Phase
from castx.process.events import Events

pytestmark = pytest.mark.serial


def phase(stage=1, cycle=2) -> Phase:
    return Phase(start=5.0, cycle=cycle, stage=stage, cycle_start=4.0)


def test_a_stage_is_noted_with_what_it_changes(caplog):
    caplog.set_level(logging.INFO)
    events = Events()
    forces = {"core": {"friction": 0.2, "normal": 1000.0, "force": 200.0}}
    here = {"casting": 1.0, "core": 1.0}
    events.note_stage(5.0, phase(), here, removed={"mould": 1.0}, renewed=[], forces=forces)
    (event,) = json.loads(json.dumps(events.known))
    assert event == {
        "time": 5.0, "cycle": 2, "stage": 1, "bodies": ["casting", "core"],
        "removed": {"mould": 1.0}, "renewed": [], "ejection": forces,
    }  # fmt: skip
    assert caplog.messages[0] == "t = 5 s: cycle 2, stage 1 with casting, core"
    assert caplog.messages[1].startswith("core: about 200 N to draw it, friction 0.2")
    assert not [r for r in caplog.records if r.levelno >= logging.WARNING]


def test_a_body_that_is_removed_before_it_is_solid_is_warned_of(caplog):
    Events().note_stage(
        5.0, phase(), {"mould": 1.0}, removed={"casting": 0.934, "core": 1.0}, renewed=[], forces={}
    )
    warnings = [r.message for r in caplog.records if r.levelno == logging.WARNING]
    assert warnings == ["casting is removed at t = 5 s though only 93.4 % of it is solid"]


@pytest.mark.parametrize(
    "removed, renewed, told", [(["die"], [], True), ([], [], False), (["die"], ["casting"], False)]
)
def test_a_casting_that_is_not_solid_as_its_mould_leaves_is_told(caplog, removed, renewed, told):
    caplog.set_level(logging.INFO)
    Events().note_stage(
        18.0, phase(), {"casting": 0.885, "core": 1.0}, removed=dict.fromkeys(removed, 1.0),
        renewed=renewed, forces={},
    )  # fmt: skip
    assert caplog.messages[1:] == ["casting is 88.5 % solid as die leaves"] * told


def test_cycles_are_periodic_when_change_and_distance_are_small(caplog):
    """Changes of 8, 2 and 0.5 K leave 0.5/3 K: the ratio is a quarter."""
    caplog.set_level(logging.INFO)
    events = Events()
    for cycle, change in enumerate((None, 8.0, 2.0, 0.5), start=1):
        events.note_cycle(4.0 * cycle, cycle, change, periodic=0.6)
    assert [event["periodic"] for event in events.known] == [False, False, False, True]
    assert [event["distance"] for event in events.known[:2]] == [None, None]
    assert events.known[2]["distance"] == pytest.approx(2.0 / 3.0)
    assert events.known[3]["distance"] == pytest.approx(0.5 / 3.0)
    assert len(caplog.messages) == 3  # of the first cycle nothing is known
    assert caplog.messages[0] == (
        "cycle 2 ends within 8 K of the one before: not periodic yet (0.6 K)"
    )
    assert caplog.messages[-1].endswith("about 0.167 K from the periodic state: periodic (0.6 K)")


def test_stages_between_the_cycles_do_not_disturb_the_comparison():
    events = Events()
    for cycle, change in ((2, 8.0), (3, 2.0)):
        events.note_stage(4.0, phase(), {"casting": 0.5}, removed={}, renewed=[], forces={})
        events.note_cycle(4.0 * cycle, cycle, change, periodic=0.6)
    assert events.known[-1]["distance"] == pytest.approx(2.0 / 3.0)
