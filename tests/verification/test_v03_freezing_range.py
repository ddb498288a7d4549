"""V3: an alloy with a freezing range solidifies at a chilled wall.

Source: similarity solution in η = x/√t as for Neumann's problem (J. A. Dantzig, M. Rappaz,
Solidification (2009), section 5); with properties that vary along the freezing range it is the
ordinary problem

    (k(T) T')' + η/2 C(T) T' = 0,   T(0) = wall,   T(∞) = start,   C = c(T) − L df_s/dT,

solved here by shooting for the flux at the wall.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from castx.heat.body import HeatBody
from castx.heat.problem import HeatProblem
from tests.verification.heat_strips import material, profile, run, strip, wall_at

KS, KL, CS, CL, LATENT = 180.0, 85.0, 2.75e6, 2.70e6, 9.8e8
SOLIDUS, LIQUIDUS, WALL, START = 560.0, 615.0, 300.0, 640.0
FARTHEST = 60e-3
"""η at which the melt is still at its start temperature [m/√s]."""


def solid_fraction(T: float) -> float:
    return min(max((LIQUIDUS - T) / (LIQUIDUS - SOLIDUS), 0.0), 1.0)


def rates(eta, state, mushy: bool) -> list[float]:
    T, flux = state
    fraction = solid_fraction(T)
    gradient = flux / (fraction * KS + (1 - fraction) * KL)
    capacity = fraction * CS + (1 - fraction) * CL + mushy * LATENT / (LIQUIDUS - SOLIDUS)
    return [gradient, -eta / 2 * capacity * gradient]


def shoot(flux: float) -> list:
    """Return the solutions in the solid, the mushy zone and the liquid."""
    state, begin, parts = [WALL, flux], 0.0, []
    for mushy, goal in ((False, SOLIDUS), (True, LIQUIDUS), (False, np.inf)):

        def reached(eta, state, mushy, goal=goal):
            return state[0] - goal if np.isfinite(goal) else -1.0

        vars(reached)["terminal"] = True
        parts.append(
            solve_ivp(
                rates,
                (begin, FARTHEST),
                state,
                method="DOP853",
                rtol=1e-11,
                atol=1e-9,
                args=(mushy,),
                events=reached,
                dense_output=True,
            )
        )
        state, begin = parts[-1].y[:, -1], parts[-1].t[-1]
        if begin >= FARTHEST:
            break
    return parts


@cache
def similarity() -> tuple[float, list]:
    """Return the flux at the wall times √t and the three parts of the solution."""
    flux = brentq(lambda q: shoot(q)[-1].y[0, -1] - START, 5e6, 9e6, rtol=1e-13)
    return flux, shoot(flux)


def exact(x, time):
    _, parts = similarity()
    eta = np.minimum(np.asarray(x) / np.sqrt(time), FARTHEST)
    temperature = np.empty_like(eta)
    for part in reversed(parts):
        inside = eta <= part.t[-1]
        temperature[inside] = part.sol(eta[inside])[0]
    return temperature


def crossing(x, temperature, level: float) -> float:
    """Return where a rising profile passes a temperature."""
    return float(np.interp(level, temperature, x))


def solve(comm, size: float, step: float) -> dict[str, float]:
    """Run to 10 s and return the errors."""
    mesh = strip(comm, size=size, length=0.12)
    alloy = material(
        heat_capacity={"solid": CS, "liquid": CL},
        conductivity={"solid": KS, "liquid": KL},
        latent_heat=LATENT,
        solidus=SOLIDUS,
        liquidus=LIQUIDUS,
    )
    heat = HeatProblem(mesh, [HeatBody("casting", alloy, START)], (), [wall_at(WALL)])
    passed: list[float] = []
    run(heat, step, 10.0, look=lambda time: passed.append(-heat.totals()["casting/wall.heat"]))
    x, temperature = profile(mesh, heat, "casting")
    flux, parts = similarity()
    last = 2 * flux * (np.sqrt(10.0) - np.sqrt(10.0 - step)) / step
    error = temperature - exact(x, 10.0)
    fronts = [part.t[-1] * np.sqrt(10.0) for part in parts[:2]]
    return {
        "temperature": np.abs(error).max(),
        "norm": np.abs(error).mean(),
        "solidus": abs(crossing(x, temperature, SOLIDUS) / fronts[0] - 1),
        "liquidus": abs(crossing(x, temperature, LIQUIDUS) / fronts[1] - 1),
        "flux": abs((passed[-1] - passed[-2]) / step / size / last - 1),
        "heat": abs(passed[-1] / size / (2 * flux * np.sqrt(10.0)) - 1),
        "energy": heat.totals()["energy_error"],
    }


def test_the_exact_solution_is_that_of_the_record():
    flux, parts = similarity()
    assert flux == pytest.approx(6.668644e6, rel=1e-6)
    fronts = [part.t[-1] for part in parts[:2]]
    assert fronts == pytest.approx([7.527429e-3, 1.0481317e-2], rel=1e-6)
    assert exact(np.array([2e-3, 4e-3, 6e-3, 10e-3]), 1.0) == pytest.approx(
        [373.720, 445.228, 512.507, 611.442], abs=1e-3
    )
    assert abs(parts[2].y[1, -1]) < 1e-6 * flux


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
