"""Steps follow the solid fraction where metal freezes at one temperature, at which none changes.

Pure aluminium in a steel mould, with a gap that opens as the skin contracts. The reference is a run
in steps that freeze 0.5 % of the casting; implicit Euler's error is of first order in the step. The
skin of an alloy is pulled by its wall until what is left of its liquid lets go, and it flows.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.coupled_cases import cylinder, final_state, states

pytestmark = pytest.mark.serial


def freezing(comm: Any, **time: float) -> tuple[float, float]:
    """Return the solid fraction and the mean gap [m] after 30 s."""
    steps = {"end": 30.0, "first_step": 0.05, "largest_step": 5.0, **time}
    data = cylinder({"time": steps}, size=0.0025)
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
    assert max(of_solid) < 0.004 and of_solid[-1] < 0.0015
    unseen, default, fine = of_gap
    assert 0.004 > unseen > 1.1 * default > 1.1 * fine


@pytest.mark.slow
def test_a_skin_lets_go_of_its_wall_in_steps_of_half_the_size_at_the_same_time(comm):
    """With cells at the wall that resolve the skin, and heat that takes no notice of gaps."""
    opened, gaps = zip(*(leaving(comm, skin_change=c) for c in (0.05, 0.025)), strict=True)
    assert opened[0] == pytest.approx(opened[1], abs=0.2)
    assert gaps[0] == pytest.approx(gaps[1], rel=0.06)


def leaving(comm: Any, **time: float) -> tuple[float, float]:
    """Return when the skin of an alloy leaves its wall [s], and its gap at 26 s [m]."""
    geometry: dict[str, Any] = {"size": 0.005, "interface_size": 0.0004, "height": 0.02}
    data = cylinder({"time": {"end": 26.0, "largest_step": 2.0, **time}}, **geometry)
    data["bodies"][0] |= {"material": "AlSi7Mg", "law": "thermo-elasto-viscoplastic"}
    data["bodies"][1]["material"] = "steel-H13"
    data["materials"], data["coupling"] = {}, {"scheme": "one-way"}
    opened, gap = np.inf, 0.0
    for state in states(comm, data):
        gap = state.totals["casting/mould.mean_gap"]
        if state.totals["casting/mould.closed_fraction"] < 0.5:
            opened = min(opened, state.time)
    return opened, gap
