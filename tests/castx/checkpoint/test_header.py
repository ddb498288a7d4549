"""A header without what a run goes on with is refused, and so is a state that is not a number."""

from __future__ import annotations

import numpy as np
import pytest

from castx.checkpoint.header import checked, refuse_what_is_no_number
from castx.errors import CaseError

pytestmark = pytest.mark.serial

GOOD = {
    "format": 1, "castx": "0.1.0", "written": "2026-11-24T16:42:16+00:00", "time": 0.2, "step": 4,
    "ranks": 1, "mesh": "8da4", "case": {"time": {"end": 1.0}}, "process": {"phase": 0},
    "results": {"rows": 5}, "arrays": ["simulation/clock/time"],
}  # fmt: skip


def test_a_whole_header_is_returned_as_it_is():
    assert checked(GOOD, "state.npz") is GOOD


@pytest.mark.parametrize("key", [key for key in GOOD if key != "format"])
def test_a_header_without_an_entry_is_refused(key):
    for header in ({k: v for k, v in GOOD.items() if k != key}, {**GOOD, key: object()}):
        with pytest.raises(CaseError, match=rf"checkpoint state.npz is damaged: {key}: "):
            checked(header, "state.npz")


@pytest.mark.parametrize("time", [-1.0, np.nan, np.inf, "soon"])
def test_a_time_that_is_none_is_refused(time):
    with pytest.raises(CaseError, match=r"damaged: time: .*start the run anew without --restart"):
        checked({**GOOD, "time": time}, "state.npz")


@pytest.mark.parametrize(
    ("name", "refused"),
    [
        ("simulation/process/problem/heat/enthalpy/casting", True),
        ("simulation/process/problem/mechanics/motion/mould", True),
        ("simulation/process/problem/mechanics/bodies/mould/points/elastic", True),
        ("results/histories/openings/casting/mould/times", False),
    ],
)
def test_only_histories_may_hold_what_is_not_a_number(name, refused):
    arrays = {"simulation/clock/time": np.array(1.0), name: np.array([1.0, np.nan])}
    if not refused:
        refuse_what_is_no_number(arrays, "state.npz")
        return
    with pytest.raises(CaseError, match=f"{name} is not a number"):
        refuse_what_is_no_number(arrays, "state.npz")
