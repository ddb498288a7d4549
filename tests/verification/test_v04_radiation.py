"""V4: two lumped bodies that exchange heat by radiation alone, through the gap between them.

Reference: `castx/proof/verification/heat/radiation.py`; the numbers of the case, and other data.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from castx.proof.verification.heat.radiation import TIMES, Lumps
from tests import coupled_cases

GIVEN = Lumps()
COLDER = Lumps(0.07, (0.9, 0.2), (4000.0, 500.0), (180.0, 900.0))


def largest_error(comm, bodies: Lumps, steps: int, exact: np.ndarray) -> float:
    rows = []
    for state in coupled_cases.states(comm, bodies.case(steps)):
        fields = [coupled_cases.nodal(state, name, "temperature") for name in ("casting", "mould")]
        assert all(np.ptp(field) < 1e-2 for field in fields)
        rows.append((state.time, *(field.mean() for field in fields)))
    assert state.totals["energy_error"] < 1e-6
    given = bodies.capacities[0] * (bodies.temperatures[0] - rows[-1][1])
    assert state.totals["casting/mould.heat.radiation"] == pytest.approx(given, rel=1e-5)
    time, *temperatures = np.transpose(rows)
    found = np.transpose([np.interp(TIMES, time, T) for T in temperatures])
    return float(np.abs(found - exact).max())


def test_given_numbers(comm):
    exact = np.transpose([
        (637.3752, 624.7570, 573.8996, 490.8956, 367.0859),
        (220.9843, 225.7161, 244.7876, 275.9141, 322.3428),
    ])  # fmt: skip
    assert largest_error(comm, GIVEN, 500, exact) < 0.5
    assert np.abs(GIVEN.reference(TIMES) - exact).max() < 1e-4


@pytest.mark.slow
@pytest.mark.serial
def test_error_falls_with_the_step(comm):
    exact = COLDER.reference(TIMES)
    errors = [largest_error(comm, COLDER, steps, exact) for steps in (500, 1000)]
    assert errors[1] < 2.0
    assert errors[0] / errors[1] > 1.6


@pytest.mark.sampled
@pytest.mark.serial
@pytest.mark.parametrize("change", [{"emissivities": (0.35, 0.5)}, {"emissivities": (0.25, 0.85)}])
def test_each_emissivity_acts(comm, change):
    bodies = replace(GIVEN, **change)
    assert largest_error(comm, bodies, 500, bodies.reference(TIMES)) < 0.5
    assert np.abs(bodies.reference(TIMES) - GIVEN.reference(TIMES)).max() > 5.0
