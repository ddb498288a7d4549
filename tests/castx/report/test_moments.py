"""Moments of a run: what its pictures show."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from castx.report.moments import moments
from castx.results.files.run_tables import Columns

pytestmark = pytest.mark.serial

TIME = np.arange(11.0)


def test_moments_are_those_at_which_something_happens():
    history = Columns(
        {
            "time": TIME,
            "casting.solid_fraction": np.clip((TIME + 0.5) / 8.0, 0.0, 1.0),
            "casting/mould.max_gap": np.where(TIME > 2.5, 1e-5, 0.0),
        }
    )
    events = [{"stage": 1, "cycle": 1, "time": 8.0}, {"stage": 1, "cycle": 2, "time": 9.0}]
    record = {"interfaces": {"casting/mould": {}}, "process": events}
    run = SimpleNamespace(history=history, record=record, freezing=["casting"])
    assert {round(time, 9): text for time, text in moments(run).items()} == {
        1.5: "25 % solid",
        3.0: "first air gap",
        3.5: "50 % solid",
        5.5: "75 % solid",
        7.2: "95 % solid",
        8.0: "all solid, stage 1",
        10.0: "end",
    }


def test_a_run_in_which_nothing_freezes_has_its_end():
    run = SimpleNamespace(history=Columns({"time": TIME}), record={"interfaces": {}}, freezing=[])
    assert moments(run) == {10.0: "end"}
