"""V11: viscoplastic bars through the case file, as case files see them.

Maxwell: Bingham flow without yield stress, ε̇_vp = σ/(3η), length held, cooled at Ṫ:
σ = 3ηαṪ (1 − exp(−E t/(3η))).
Norton relaxation at constant length, ε̇_vp = A σⁿ: σ^(1−n) = σ0^(1−n) + (n − 1) E A t.
Perzyna's flow with hardening and temperature-dependent properties: the rate equations, integrated.

Implicit Euler has the closed forms σ_k (1 + E Δt/(3η)) = σ_(k−1) + E α Ṫ Δt and σ_k + E A Δt σ_kⁿ =
σ_(k−1): every model and formulation must reproduce those to the tolerance of its solver.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from castx.arrays import FloatArray
from castx.proof.verification.solids.viscoplastic_bars import (
    COEFFICIENT,
    COOLING,
    CREEPING,
    EXPANSION,
    EXPONENT,
    KINDS,
    START,
    VISCOPLASTIC,
    VISCOSITY,
    YOUNG,
    Kind,
    bar,
    exact_maxwell,
    exact_norton,
    maxwell,
    norton,
)
from tests.verification.bars import stresses

pytestmark = pytest.mark.sampled

COARSE = 12


def implicit_maxwell(end: float, steps: int) -> FloatArray:
    dt, stress, found = end / steps, 0.0, []
    for _ in range(steps):
        stress += YOUNG * EXPANSION * COOLING * dt
        stress /= 1 + YOUNG * dt / (3 * VISCOSITY)
        found.append(stress)
    return np.array(found)


def implicit_norton(end: float, steps: int) -> FloatArray:
    dt, stress, found = end / steps, START, []

    def excess(new: float, old: float) -> float:
        return new + CREEPING * COEFFICIENT * dt * new**EXPONENT - old

    for _ in range(steps):
        stress = brentq(excess, 0.0, stress, args=(stress,), xtol=1e-6, rtol=1e-15)
        found.append(stress)
    return np.array(found)


@pytest.mark.serial  # ranks agree in the test of Perzyna's flow
@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_maxwell_in_every_formulation(comm, kind):
    found = stresses(comm, maxwell(kind, 20.0, COARSE))
    np.testing.assert_allclose(found, implicit_maxwell(20.0, COARSE), rtol=1e-7)


@pytest.mark.serial  # ranks agree in the test of Perzyna's flow
@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_norton_in_every_formulation(comm, kind):
    found = stresses(comm, norton(kind, 10.0, COARSE))
    np.testing.assert_allclose(found, implicit_norton(10.0, COARSE), rtol=1e-6)


@pytest.mark.serial
@pytest.mark.parametrize("end, times", [(20.0, (1.0, 5.0, 20.0)), (100.0, (100.0,))])
def test_400_steps_of_maxwell(comm, end, times):
    found = stresses(comm, maxwell(KINDS["generalised"], end, 400))
    for time in times:
        assert found[round(400 * time / end) - 1] == pytest.approx(exact_maxwell(time), rel=5e-3)


@pytest.mark.serial
@pytest.mark.parametrize("end", [100.0, 1000.0])
def test_400_steps_of_norton(comm, end):
    found = stresses(comm, norton(KINDS["generalised"], end, 400))
    assert found[-1] == pytest.approx(exact_norton(end), rel=5e-3)


@pytest.mark.serial
@pytest.mark.parametrize(
    "case, exact, end", [(maxwell, exact_maxwell, 20.0), (norton, exact_norton, 100.0)]
)
def test_error_falls_with_the_step(comm, case, exact, end):
    errors = [
        stresses(comm, case(KINDS["space"], end, steps))[-1] - exact(end) for steps in (50, 100)
    ]
    assert 1.8 < errors[0] / errors[1] < 2.2


HOT, COLD = 450.0, 250.0
AT_COLD = {
    "young_modulus": 62e9, "yield_stress": 38e6, "linear": 500e6, "saturation": 25e6, "rate": 90.0,
    "kinematic": 1.5e9, "viscosity": 3e9, "exponent": 1.5, "expansion": 2.1e-5,
}  # fmt: skip
AT_HOT = {
    "young_modulus": 48e9, "yield_stress": 16e6, "linear": 200e6, "saturation": 9e6, "rate": 140.0,
    "kinematic": 0.7e9, "viscosity": 1.5e9, "exponent": 1.4, "expansion": 2.4e-5,
}  # fmt: skip
TEMPERATURES = [[0.0, HOT], [12.0, COLD], [30.0, 400.0]]
STRAINS = [[0.0, 0.0], [9.0, 2e-3], [18.0, -3e-3], [30.0, 4e-3]]


def perzyna(kind: Kind, steps: int) -> dict[str, Any]:
    """Return a bar that is cooled and heated, pulled and pushed; tables are linear in between."""

    def table(key: str) -> list[list[float]]:
        return [[COLD, AT_COLD[key]], [HOT, AT_HOT[key]]]

    material = {
        "poisson_ratio": 0.33, "law": "perzyna", "stress_free": HOT, "expansion_reference": 20.0,
        "hardening": {key: table(key) for key in ("linear", "saturation", "rate")},
        "kinematic_hardening": table("kinematic"),
        **{key: table(key) for key in
           ("young_modulus", "yield_stress", "viscosity", "exponent", "expansion")},
    }  # fmt: skip
    return bar(kind, material, VISCOPLASTIC, TEMPERATURES, STRAINS, end=30.0, steps=steps)


def exact_perzyna(times: FloatArray) -> FloatArray:
    """Integrate the rate equations; the stress at times [Pa]."""

    def at(time: float) -> dict[str, float]:
        share = (float(np.interp(time, *np.transpose(TEMPERATURES))) - COLD) / (HOT - COLD)
        return {key: cold + share * (AT_HOT[key] - cold) for key, cold in AT_COLD.items()}

    def stress(time: float, flowed: float) -> float:
        temperature = float(np.interp(time, *np.transpose(TEMPERATURES)))
        free = at(time)["expansion"] * (temperature - 20.0) - AT_HOT["expansion"] * (HOT - 20.0)
        total = float(np.interp(time, *np.transpose(STRAINS)))
        return at(time)["young_modulus"] * (total - free - flowed)

    def rate(time: float, state: FloatArray) -> list[float]:
        flowed, equivalent = state
        now = at(time)
        driving = stress(time, flowed) - now["kinematic"] * flowed
        resisting = now["yield_stress"] + now["linear"] * equivalent
        resisting += now["saturation"] * -np.expm1(-now["rate"] * equivalent)
        speed = (max(abs(driving) - resisting, 0.0) / now["viscosity"]) ** now["exponent"]
        return [np.sign(driving) * speed, speed]

    kinks = sorted({time for time, _ in (*TEMPERATURES, *STRAINS)})
    state, found = np.zeros(2), []
    for begin, end in pairwise(kinks):
        path = solve_ivp(
            rate, (begin, end), state, method="LSODA", rtol=1e-10, atol=1e-13, dense_output=True
        )
        state = path.y[:, -1]
        inside = times[(times > begin) & (times <= end)]
        found += [stress(time, path.sol(time)[0]) for time in inside]
    return np.array(found)


@pytest.mark.serial
def test_perzyna_follows_the_rate_equations(comm):
    exact = exact_perzyna(np.linspace(0.6, 30.0, 50))
    coarse, fine = (
        stresses(comm, perzyna(KINDS["generalised"], steps))[steps // 50 - 1 :: steps // 50]
        for steps in (100, 200)
    )
    size = np.abs(exact).max()
    errors = [np.abs(found - exact).mean() / size for found in (coarse, fine)]
    assert errors[1] < 0.01
    assert 1.7 < errors[0] / errors[1] < 2.2
    assert np.abs(2 * fine - coarse - exact).max() < 0.01 * size


@pytest.mark.parametrize("name", [name for name in KINDS if name != "generalised"])
def test_perzyna_in_every_formulation(comm, known, name):
    if not known:
        known.append(stresses(comm, perzyna(KINDS["generalised"], 10)))
    found = stresses(comm, perzyna(KINDS[name], 10))
    np.testing.assert_allclose(found, known[0], rtol=1e-6)


@pytest.fixture(scope="module")
def known() -> list[FloatArray]:
    return []
