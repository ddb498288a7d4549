"""The largest gap over a run."""

import numpy as np
import pytest

from castx.errors import CaseError
from castx.report.summary.gaps import gaps
from castx.results.files.run_tables import Columns
from tests.castx.report.summary.fake_run import TIME, run

pytestmark = pytest.mark.serial


def test_the_widest_moment_counts_with_its_place():
    (gap,) = gaps(run())
    assert gap.number == "5 µm" and gap.time == 2.0 and gap.place == [0.04, 0.01]
    assert "exceeds 1 µm first in the step to 2 s" in gap.sentence
    assert gap.shown.moved and not gap.shown.outside
    (space,) = gaps(run(model="3d"))
    assert space.shown.field == "gap" and space.shown.outside


def test_the_widest_interface_comes_first_and_closed_ones_say_so():
    history = {"time": TIME, "a/b.max_gap": 0.0 * TIME, "a/c.max_gap": 1e-6 * TIME}
    found = run(history=Columns(history), interfaces=("a/b", "a/c", "a/d"))
    wide, closed = gaps(found)
    assert wide.of == "a/c" and closed.value == 0.0 and "touch all the time" in closed.sentence


@pytest.mark.parametrize("width, value", [(0.9e-9, 0.0), (1.1e-9, 1.1e-9)])
def test_a_gap_of_less_than_a_nanometre_is_none(width, value):
    history = Columns({"time": TIME, "a/b.max_gap": width + 0.0 * TIME})
    (gap,) = gaps(run(history=history, interfaces=("a/b",)))
    assert gap.value == value


def test_the_place_is_unknown_where_a_body_is_gone():
    def gone(name, time):
        raise CaseError("no body")

    (gap,) = gaps(run(interface=gone))
    assert gap.place is None and gap.value == 5e-6


def test_a_gap_before_a_body_was_removed_counts():
    widths = np.array([0.0, 3e-6, np.nan, np.nan])
    (gap,) = gaps(run(history=Columns({"time": TIME, "casting/mould.max_gap": widths})))
    assert gap.value == 3e-6 and gap.time == 1.0


def test_a_thermal_run_knows_no_gaps():
    found = run()
    found.record["scheme"] = "thermal"
    assert not list(gaps(found))
