"""V3: an alloy with a freezing range solidifies at a chilled wall, by the heat problem alone.

Reference: `castx/proof/verification/heat/freezing_range.py`.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.heat.body import HeatBody
from castx.heat.problem import HeatProblem
from castx.proof.verification.heat.freezing_range import FreezingRange
from tests.verification.heat_strips import material, profile, run, strip, wall_at

EXACT = FreezingRange()


def crossing(x, temperature, level: float) -> float:
    """Return where a rising profile passes a temperature."""
    return float(np.interp(level, temperature, x))


def solve(comm, size: float, step: float) -> dict[str, float]:
    """Run to 10 s and return the errors."""
    mesh = strip(comm, size=size, length=0.12)
    alloy = material(**EXACT.material())
    heat = HeatProblem(mesh, [HeatBody("casting", alloy, EXACT.start)], (), [wall_at(EXACT.wall)])
    passed: list[float] = []
    run(heat, step, 10.0, look=lambda time: passed.append(-heat.totals()["casting/wall.heat"]))
    x, temperature = profile(mesh, heat, "casting")
    flux = EXACT.flux
    last = 2 * flux * (np.sqrt(10.0) - np.sqrt(10.0 - step)) / step
    error = temperature - EXACT.temperature(x, 10.0)
    fronts = [front * np.sqrt(10.0) for front in EXACT.fronts]
    return {
        "temperature": np.abs(error).max(),
        "norm": np.abs(error).mean(),
        "solidus": abs(crossing(x, temperature, EXACT.solidus) / fronts[0] - 1),
        "liquidus": abs(crossing(x, temperature, EXACT.liquidus) / fronts[1] - 1),
        "flux": abs((passed[-1] - passed[-2]) / step / size / last - 1),
        "heat": abs(passed[-1] / size / (2 * flux * np.sqrt(10.0)) - 1),
        "energy": heat.totals()["energy_error"],
    }


@pytest.mark.serial
def test_errors_at_half_a_millimetre_and_their_fall(comm):
    coarse, fine = solve(comm, 1e-3, 0.04), solve(comm, 0.5e-3, 0.02)
    assert fine["temperature"] < 1.5
    assert fine["solidus"] < 0.015
    assert fine["liquidus"] < 0.015
    assert fine["flux"] < 0.01
    assert fine["energy"] < 1e-6
    for measure in ("norm", "heat"):
        assert coarse[measure] > 1.6 * fine[measure], measure
