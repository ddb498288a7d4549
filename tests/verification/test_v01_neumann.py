"""V1: solidification of a pure metal at a chilled wall.

Source: F. Neumann's similarity solution, as in J. Crank, Free and Moving Boundary Problems (1984),
section 1.3. With X = 2λ√(α_s t) the front and r = √(α_s/α_l), λ solves

    k_s (Tm − Tw) e^(−λ²)/(√(πα_s) erf λ) − k_l (Ti − Tm) e^(−λ²r²)/(√(πα_l) erfc(λr)) = L λ √α_s.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import erf, erfc

from castx.heat.body import HeatBody
from castx.heat.problem import HeatProblem
from tests.verification.heat_strips import material, profile, run, solid_thickness, strip, wall_at

KS, KL, CS, CL, LATENT, TM, TW, TI = 210.0, 95.0, 3.0e6, 2.58e6, 1.08048e9, 660.0, 580.0, 740.0
AS, AL = KS / CS, KL / CL
RATIO = np.sqrt(AS / AL)


def stefan(x: float) -> float:
    """Return the heat balance of the front."""
    solid = KS * (TM - TW) * np.exp(-(x**2)) / (np.sqrt(np.pi * AS) * erf(x))
    liquid = KL * (TI - TM) * np.exp(-((x * RATIO) ** 2)) / (np.sqrt(np.pi * AL) * erfc(x * RATIO))
    return solid - liquid - LATENT * x * np.sqrt(AS)


LAMBDA = brentq(stefan, 1e-3, 3.0, xtol=1e-15)


def front(time: float) -> float:
    return 2 * LAMBDA * np.sqrt(AS * time)


def wall_heat(time: float) -> float:
    """Return the heat through the wall per area [J/m²]."""
    return 2 * KS * (TM - TW) * np.sqrt(time) / (np.sqrt(np.pi * AS) * erf(LAMBDA))


def exact(x, time):
    solid = TW + (TM - TW) * erf(x / (2 * np.sqrt(AS * time))) / erf(LAMBDA)
    liquid = TI - (TI - TM) * erfc(x / (2 * np.sqrt(AL * time))) / erfc(LAMBDA * RATIO)
    return np.where(x < front(time), solid, liquid)


def solve(comm, size: float, step: float, cells: str) -> dict[str, float]:
    """Run to 10 s and return the errors."""
    mesh = strip(comm, size=size, length=0.12, cells=cells)
    metal = material(
        heat_capacity={"solid": CS, "liquid": CL},
        conductivity={"solid": KS, "liquid": KL},
        latent_heat=LATENT,
        solidus=TM,
        liquidus=TM,
    )
    heat = HeatProblem(mesh, [HeatBody("casting", metal, TI)], (), [wall_at(TW)])
    thickness: dict[float, float] = {}
    run(heat, step, 10.0, look=lambda t: thickness.update({t: solid_thickness(mesh, heat, size)}))
    x, temperature = profile(mesh, heat, "casting")
    away = np.abs(x - front(10.0)) > 2 * size
    late = [t for t in thickness if t >= 1.0]
    error = temperature - exact(x, 10.0)
    totals = heat.totals()
    return {
        "temperature": np.abs(error[away]).max(),
        "norm": np.abs(error).mean(),
        "front": abs(thickness[max(late)] / front(10.0) - 1),
        "front history": np.sqrt(np.mean([(thickness[t] / front(t) - 1) ** 2 for t in late])),
        "heat": abs(-totals["casting/wall.heat"] / size / wall_heat(10.0) - 1),
        "energy": totals["energy_error"],
    }


def test_the_exact_solution_is_that_of_the_record():
    assert pytest.approx(0.2729601290, abs=1e-10) == LAMBDA
    assert front(1.0) == pytest.approx(4.567496576e-3, rel=1e-9)
    assert wall_heat(1.0) == pytest.approx(2 * 3.76973e6, rel=1e-6)
    assert exact(np.array([5e-3, 10e-3, 20e-3]), 10.0) == pytest.approx(
        [608.299, 636.098, 677.954], abs=1e-3
    )


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
