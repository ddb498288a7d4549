"""Checks of the tolerance of the steps: a run must have what it bounds."""

from __future__ import annotations

from collections.abc import Iterator

from castx.case.case import Case
from castx.input.problems import Problem

LACKING = {
    "thermal": (("gap", "strain"), 'nothing moves with scheme = "thermal"'),
    "mechanical": (("temperature",), 'temperatures are given with scheme = "mechanical"'),
}
"""For each scheme that lacks something the keys of the tolerance that have no meaning, and why."""


def step_tolerance_problems(case: Case) -> Iterator[Problem]:
    """Yield tolerances of what the run does not compute."""
    tolerance = case.time.tolerance
    if tolerance is None:
        return
    keys, reason = LACKING.get(case.coupling.scheme, ((), ""))
    for key in keys:
        if getattr(tolerance, key) is not None:
            yield Problem(("time", "tolerance", key), f"{reason}: leave it out")
