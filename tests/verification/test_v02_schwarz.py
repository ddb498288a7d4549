"""V2: a melt on a mould in perfect contact, both half-spaces.

Source: C. Schwarz, Arch. Eisenhüttenwes. 5 (1931) 139; J. A. Dantzig, M. Rappaz, Solidification
(2009), section 5. The interface has one temperature T_i at all times; with X = 2λ√(α_s t) the front
and r = √(α_s/α_l),

    k_m (T_i − T_0)/√α_m = k_s (Tm − T_i)/(√α_s erf λ)        heat through the interface
    k_s (Tm − T_i) e^(−λ²)/(√(πα_s) erf λ) − k_l (Ti − Tm) e^(−λ²r²)/(√(πα_l) erfc(λr))
        = L λ √α_s                                            heat at the front.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import erf, erfc

from castx.heat.body import HeatBody
from tests.heat_resistance import of_resistance
from tests.verification.heat_strips import (
    casting_on_mould,
    material,
    profile,
    run,
    solid_thickness,
    strip,
)

KS, KL, KM, CS, CL, CM, LATENT = 225.0, 92.0, 38.0, 2.95e6, 2.58e6, 4.1e6, 9.45e8
TM, T0, TI = 660.0, 200.0, 670.0
AS, AL, AM = KS / CS, KL / CL, KM / CM
RATIO = np.sqrt(AS / AL)


def interface(x: float) -> float:
    """Return the temperature of the interface for a λ."""
    mould, solid = KM / np.sqrt(AM), KS / (np.sqrt(AS) * erf(x))
    return (mould * T0 + solid * TM) / (mould + solid)


def stefan(x: float) -> float:
    """Return the heat balance of the front."""
    solid = KS * (TM - interface(x)) * np.exp(-(x**2)) / (np.sqrt(np.pi * AS) * erf(x))
    liquid = KL * (TI - TM) * np.exp(-((x * RATIO) ** 2)) / (np.sqrt(np.pi * AL) * erfc(x * RATIO))
    return solid - liquid - LATENT * x * np.sqrt(AS)


LAMBDA = brentq(stefan, 1e-3, 3.0, xtol=1e-15)
T_INTERFACE = interface(LAMBDA)


def front(time: float) -> float:
    return 2 * LAMBDA * np.sqrt(AS * time)


def mould_heat(time: float) -> float:
    """Return the heat that the mould has received per area [J/m²]."""
    return 2 * KM * (T_INTERFACE - T0) * np.sqrt(time / (np.pi * AM))


def exact(x, time):
    mould = T0 + (T_INTERFACE - T0) * erfc(-x / (2 * np.sqrt(AM * time)))
    solid = T_INTERFACE + (TM - T_INTERFACE) * erf(x / (2 * np.sqrt(AS * time))) / erf(LAMBDA)
    liquid = TI - (TI - TM) * erfc(x / (2 * np.sqrt(AL * time))) / erfc(LAMBDA * RATIO)
    return np.where(x < 0, mould, np.where(x < front(time), solid, liquid))


def solve(comm, size: float, step: float, kind: str = "perfect") -> dict[str, float]:
    """Run to 10 s and return the errors."""
    mesh = strip(comm, size=size, length=0.12, mould_length=0.06)
    metal = material(
        heat_capacity={"solid": CS, "liquid": CL},
        conductivity={"solid": KS, "liquid": KL},
        latent_heat=LATENT,
        solidus=TM,
        liquidus=TM,
    )
    steel = material(heat_capacity=CM, conductivity=KM)
    bodies = [HeatBody("casting", metal, TI), HeatBody("mould", steel, T0)]
    heat = casting_on_mould(mesh, bodies, kind)
    thickness: dict[float, float] = {}
    pairs = mesh.bodies["casting"].surface_nodes("mould")
    owned = mesh.bodies["casting"].nodes.dofmap.index_map.size_local
    state = of_resistance(np.full(np.count_nonzero(pairs < owned), 1e-8))
    run(
        heat,
        step,
        10.0,
        [(state, state)],
        look=lambda t: thickness.update({t: solid_thickness(mesh, heat, size)}),
    )
    errors = [
        np.column_stack((x, temperature - exact(x - 1e-12 * (body == "mould"), 10.0)))
        for body in ("casting", "mould")
        for x, temperature in [profile(mesh, heat, body)]
    ]
    x, error = np.concatenate(errors).T
    away = np.abs(x - front(10.0)) > 2 * size
    late = [t for t in thickness if t >= 1.0]
    totals = heat.totals()
    return {
        "temperature": np.abs(error[away]).max(),
        "norm": np.abs(error).mean(),
        "front": abs(thickness[max(late)] / front(10.0) - 1),
        "front history": np.sqrt(np.mean([(thickness[t] / front(t) - 1) ** 2 for t in late])),
        "heat": abs(totals["mould.heat_in"] / size / mould_heat(10.0) - 1),
        "interface": abs(totals["casting/mould.heat"] / totals["mould.heat_in"] - 1),
        "energy": totals["energy_error"],
    }


def test_the_exact_solution_is_that_of_the_record():
    assert pytest.approx(0.2949360318, abs=1e-10) == LAMBDA
    assert pytest.approx(597.6895, abs=1e-4) == T_INTERFACE
    assert front(1.0) == pytest.approx(5.151552e-3, rel=1e-6)
    assert exact(np.array([-10e-3, -5e-3, 5e-3, 10e-3, 20e-3]), 10.0) == pytest.approx(
        [383.991, 483.726, 617.317, 636.625, 661.623], abs=1e-3
    )


def check(errors: dict[str, float]) -> None:
    assert errors["temperature"] < 1.5
    assert errors["front"] < 0.02
    assert errors["heat"] < 0.01
    assert errors["interface"] < 1e-10
    assert errors["energy"] < 1e-6


@pytest.mark.serial
def test_one_temperature(comm):
    check(solve(comm, 0.5e-3, 0.02))


@pytest.mark.serial
def test_errors_fall(comm):
    # The heat is too large by h²/(24 α_m t) and too small by 0.11 Δt/t: at these steps, one leads.
    coarse, fine = solve(comm, 0.5e-3, 0.08), solve(comm, 0.25e-3, 0.04)
    for measure in ("norm", "front history", "heat"):
        assert coarse[measure] > 1.6 * fine[measure], measure


@pytest.mark.serial
def test_small_resistance(comm):
    check(solve(comm, 0.5e-3, 0.04, kind="law"))
