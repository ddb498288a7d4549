"""V1: solidification of a pure metal at a chilled wall, by the heat problem alone.

Reference: `castx/proof/verification/heat/neumann.py`.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.heat.body import HeatBody
from castx.heat.problem import HeatProblem
from castx.proof.verification.heat.neumann import Neumann
from tests.verification.heat_strips import material, profile, run, solid_thickness, strip, wall_at

EXACT = Neumann()


def solve(comm, size: float, step: float, cells: str) -> dict[str, float]:
    """Run to 10 s and return the errors."""
    mesh = strip(comm, size=size, length=0.12, cells=cells)
    metal = material(**EXACT.material())
    heat = HeatProblem(mesh, [HeatBody("casting", metal, EXACT.start)], (), [wall_at(EXACT.wall)])
    thickness: dict[float, float] = {}
    run(heat, step, 10.0, look=lambda t: thickness.update({t: solid_thickness(mesh, heat, size)}))
    x, temperature = profile(mesh, heat, "casting")
    away = np.abs(x - EXACT.front(10.0)) > 2 * size
    late = [t for t in thickness if t >= 1.0]
    error = temperature - EXACT.temperature(x, 10.0)
    totals = heat.totals()
    return {
        "temperature": np.abs(error[away]).max(),
        "norm": np.abs(error).mean(),
        "front": abs(thickness[max(late)] / EXACT.front(10.0) - 1),
        "front history": np.sqrt(np.mean([(thickness[t] / EXACT.front(t) - 1) ** 2 for t in late])),
        "heat": abs(-totals["casting/wall.heat"] / size / EXACT.wall_heat(10.0) - 1),
        "energy": totals["energy_error"],
    }


@pytest.mark.serial
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_errors_at_half_a_millimetre_and_their_fall(comm, cells):
    coarse, fine = solve(comm, 1e-3, 0.04, cells), solve(comm, 0.5e-3, 0.02, cells)
    assert fine["temperature"] < 1.5
    assert fine["front"] < 0.02
    assert fine["heat"] < 0.01
    assert fine["energy"] < 1e-6
    for measure in ("norm", "front history", "heat"):
        assert coarse[measure] > 1.6 * fine[measure], measure
