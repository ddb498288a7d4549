"""What freezes last, of pools that were followed or of the written fields."""

import numpy as np
import pytest

from castx.report.summary.freezing import LAST_LIQUID, STILL_LIQUID, earlier, freezing
from castx.results.files.run_tables import Columns
from tests.castx.report.summary.fake_run import TIME, run

pytestmark = pytest.mark.serial


def pool(ended, place):
    return {"body": "casting", "ended": ended, "place": place, "deficit": 1e-8}


def test_the_pool_that_ends_last_says_where():
    """Not when: it ends as it bears, before the last of it is solid."""
    found = run()
    found.record["hot_spots"] = [
        pool(1.7, [0.01, 0.0]), pool(1.9, [0.02, 0.01]), pool(0.9, [0.0, 0.0]), pool(None, [9, 9]),
        {**pool(1.95, [7.0, 7.0]), "body": "other"},
    ]  # fmt: skip
    (last,) = freezing(found)
    assert (last.topic, last.value, last.time) == (LAST_LIQUID, 2.0, 2.0)
    assert last.place == [0.02, 0.01] and last.number == "2 s"
    assert last.shown.time == 1.0  # the last fields with liquid
    assert "nothing can feed" in last.sentence


@pytest.mark.parametrize("deficit, lacks", [(0.0, False), (None, True)])
def test_a_pool_that_lacks_nothing_needs_no_feeder(deficit, lacks):
    """None: its shrinkage is not known."""
    found = run()
    found.record["hot_spots"] = [{**pool(1.9, [0.02, 0.01]), "deficit": deficit}]
    (last,) = freezing(found)
    assert last.place == [0.02, 0.01] and ("nothing can feed" in last.sentence) == lacks


def test_the_last_liquid_that_was_followed_says_where_it_was():
    found = run()
    found.record["last_liquid"] = {"casting": {"time": 1.0, "place": [0.013, 0.002]}}
    found.record["hot_spots"] = [pool(1.0, [0.0, 0.0])]  # it ended before the last step began
    (last,) = freezing(found)
    assert last.value == 2.0 and last.place == [0.013, 0.002]


def test_without_pools_the_fields_say_where_and_the_step_when():
    (last,) = freezing(run())
    assert last.value == 2.0 and last.place == pytest.approx([0.02, 0.0])
    assert "from 1 to 2 s" in last.sentence


def test_a_casting_that_is_not_solid_says_how_much_is_liquid():
    history = Columns({"time": TIME, "casting.solid_fraction": np.array([0.0, 0.2, 0.5, 0.75])})
    (last,) = freezing(run(history=history))
    assert last.topic == STILL_LIQUID and last.number == "25 %" and last.time == 3.0


def test_a_casting_that_melts_again_freezes_when_it_does_so_last():
    time, solid = np.arange(6.0), np.array([0.0, 0.7, 1.0, 0.4, 0.9, 1.0])
    history = Columns({"time": time, "casting.solid_fraction": solid})
    (last,) = freezing(run(history=history))
    assert (last.topic, last.value) == (LAST_LIQUID, 5.0)
    assert "from 4 to 5 s" in last.sentence
    assert last.sentence.endswith("It was all solid at 2 s already, and melted again.")
    (last,) = freezing(
        run(history=Columns({"time": time[:5], "casting.solid_fraction": solid[:5]}))
    )
    assert (last.topic, last.number, last.time) == (STILL_LIQUID, "10 %", 4.0)
    assert last.sentence == "casting was all solid at 2 s, and has melted again."


def test_of_a_casting_that_is_poured_again_the_first_pouring_counts():
    time, solid = np.arange(6.0), np.array([0.0, 0.7, 1.0, 0.1, 0.6, 0.8])
    found = run(history=Columns({"time": time, "casting.solid_fraction": solid}))
    found.record["process"] = [
        {"time": 0.0, "bodies": ["casting"], "removed": {}, "renewed": ["casting"]},
        {"time": 2.5, "bodies": ["casting"], "removed": {}, "renewed": ["casting"]},
    ]
    (last,) = freezing(found)
    assert (last.topic, last.value) == (LAST_LIQUID, 2.0)
    assert "again" not in last.sentence


@pytest.mark.parametrize(("renewed", "time"), [([], 2.0), (["casting"], 3.0)])
def test_a_casting_that_is_removed_before_it_is_solid_freezes_in_no_longer_run(renewed, time):
    history = Columns({"time": TIME, "casting.solid_fraction": np.array([0.0, 0.2, 0.5, 0.5])})
    found = run(history=history)
    found.record["process"] = [
        {"time": 2.0, "bodies": ["mould"], "removed": {"casting": 0.5}, "renewed": []},
        {"time": 2.5, "bodies": ["mould", *renewed], "removed": {}, "renewed": renewed},
        {"time": 3.0, "bodies": [], "periodic": False},
    ]
    found.record["last_liquid"] = {"casting": {"time": time, "place": [0.013, 0.002]}}
    (last,) = freezing(found)
    assert last.topic == STILL_LIQUID and last.number == "50 %" and last.time == time
    assert (last.place == [0.013, 0.002]) != bool(renewed)
    assert ("longer one" in last.sentence) == bool(renewed)
    assert ("removed at 2 s" in last.sentence) != bool(renewed)


def test_fields_before_a_moment_are_shown():
    assert earlier([0.0, 5.0, 10.0], 10.0) == 5.0
    assert earlier([3.0], 1.0) == 3.0
