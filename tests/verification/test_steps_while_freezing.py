"""Steps follow the solid fraction where metal freezes at one temperature, at which none changes.

Pure aluminium in a steel mould, with a gap that opens as the skin contracts. The reference is a run
in steps that freeze 0.5 % of the casting; implicit Euler's error is of first order in the step.
"""

from __future__ import annotations

from typing import Any

import pytest

from tests.coupled_cases import cylinder, final_state

pytestmark = pytest.mark.serial


def freezing(comm: Any, **time: float) -> tuple[float, float]:
    """Return the solid fraction and the mean gap [m] after 30 s."""
    steps = {"end": 30.0, "first_step": 0.05, "largest_step": 5.0, **time}
    data = cylinder({"time": steps}, size=0.005)
    data["materials"]["aluminium"]["liquid"] = {"viscosity": 1e5, "coherency": 0.9}
    totals = final_state(comm, data).totals
    return totals["casting.solid_fraction"], totals["casting/mould.mean_gap"]


@pytest.mark.slow
def test_smaller_changes_of_the_solid_fraction_come_closer(comm):
    exact = freezing(comm, solid_fraction_change=0.005)
    errors = [
        [abs(a / b - 1.0) for a, b in zip(freezing(comm, **time), exact, strict=True)]
        for time in ({"solid_fraction_change": 1.0}, {}, {"solid_fraction_change": 0.015})
    ]
    of_solid, of_gap = zip(*errors, strict=True)
    # A gap that is right amid a step lets more heat pass than one at its end, whose error made up
    # for that of implicit steps of the heat.
    assert max(of_solid) < 0.005 and of_solid[-1] < 0.001
    unseen, default, fine = of_gap
    assert unseen > 1.2 * default > 1.5 * fine
    assert default < 0.01
