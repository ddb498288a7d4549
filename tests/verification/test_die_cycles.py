"""A die in ten cycles: filling, ejection, spray; it comes to a periodic state, and energy closes.

Each cycle is the same map of the die's temperature, so that once the differences from cycle to
cycle are small, they shrink by the same factor each time; what the die takes in and gives away over
a cycle becomes equal.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from tests.coupled_cases import cylinder, nodal, simulation

COLD = {"type": "convection", "coefficient": 800.0, "ambient": 25.0}
EJECTION = {"at": 15.0, "remove": ["casting"], "spray": {"coefficient": 1200.0, "ambient": 25.0}}


def die(scheme: str) -> dict[str, Any]:
    data = cylinder({"coupling": {"scheme": scheme}}, size=0.01, radius=0.015)
    data["materials"]["steel"]["stress_free"] = 200.0
    data["bodies"][0]["temperature"] = 680.0
    data["boundaries"].append({"on": "mould/outside", "heat": COLD})
    data["stages"] = [EJECTION, {"at": 30.0, "repeat": 10, "renew": ["casting"]}]
    data["time"] = {"end": 30.0, "first_step": 1.0, "largest_step": 5.0, "temperature_change": 80.0}
    return data


@pytest.mark.slow
@pytest.mark.serial  # many steps; other ranks are tested with single stages
@pytest.mark.parametrize("scheme", ["thermal", "iterated"])
def test_a_die_becomes_periodic(comm, scheme):
    ends, heat, renewals, errors = [], [], [], []
    run = simulation(comm, die(scheme))
    for state in run:
        errors.append(state.totals["energy_error"])
        if state.time % 30.0 == 0.0 and state.step:
            ends.append(nodal(state, "mould", "temperature"))
            heat.append(state.totals["mould.heat_in"])
            renewals.append(state.totals["casting.renewal"])
    assert state.time == 300.0 and len(ends) == 10
    assert max(errors) < 1e-6
    changes = [float(np.abs(b - a).max()) for a, b in pairwise(ends)]
    ratios = np.array(changes[4:]) / np.array(changes[3:-1])
    assert changes[-1] < 1.0 < changes[0]
    assert ratios.max() < 0.75 and np.ptp(ratios) < 0.1
    over_cycles = np.diff(heat)
    assert abs(over_cycles[-1]) < 0.02 * (renewals[-1] - renewals[-2])
    # What the run says of it.
    said = [event for event in state.process.events if "change" in event]
    assert [event["cycle"] for event in said] == list(range(1, 11))
    np.testing.assert_allclose([event["change"] for event in said[1:]], changes, rtol=1e-9)
    distance = changes[-1] ** 2 / (changes[-2] - changes[-1])
    assert said[-1]["distance"] == pytest.approx(distance, rel=1e-6)
    periodic = [event["periodic"] for event in said]
    assert periodic == sorted(periodic) and not periodic[2] and periodic[-1]
    after = periodic.index(True)
    assert np.abs(ends[-1] - ends[after]).max() < 1.0
    # Energy: the dies' heat comes from the castings and goes through surfaces, nowhere else.
    totals = state.totals
    through = totals["casting/mould.heat"] + totals["mould/outside.heat"]
    through += totals["mould/casting.surface.heat"]
    assert totals["mould.heat_in"] == pytest.approx(through, rel=1e-9)
    run.destroy()
