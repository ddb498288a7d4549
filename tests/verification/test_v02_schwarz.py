"""V2: a melt on a mould in perfect contact, both half-spaces, by the heat problem alone.

Reference: `castx/proof/verification/heat/schwarz.py`.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.heat.body import HeatBody
from castx.proof.verification.heat.schwarz import Schwarz
from tests.heat_resistance import of_resistance
from tests.verification.heat_strips import (
    casting_on_mould,
    material,
    profile,
    run,
    solid_thickness,
    strip,
)

EXACT = Schwarz()


def solve(comm, size: float, step: float, kind: str = "perfect") -> dict[str, float]:
    """Run to 10 s and return the errors."""
    mesh = strip(comm, size=size, length=0.12, mould_length=0.06)
    metal = material(**EXACT.metal.material())
    steel = material(heat_capacity=EXACT.capacity, conductivity=EXACT.conductivity)
    start = {"casting": EXACT.metal.start, "mould": EXACT.cold}
    bodies = [HeatBody(n, m, start[n]) for n, m in (("casting", metal), ("mould", steel))]
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
        np.column_stack((x, temperature - EXACT.temperature(x - 1e-12 * (body == "mould"), 10.0)))
        for body in ("casting", "mould")
        for x, temperature in [profile(mesh, heat, body)]
    ]
    x, error = np.concatenate(errors).T
    away = np.abs(x - EXACT.casting.front(10.0)) > 2 * size
    exact_front = EXACT.casting.front
    late = [t for t in thickness if t >= 1.0]
    totals = heat.totals()
    return {
        "temperature": np.abs(error[away]).max(),
        "norm": np.abs(error).mean(),
        "front": abs(thickness[max(late)] / exact_front(10.0) - 1),
        "front history": np.sqrt(np.mean([(thickness[t] / exact_front(t) - 1) ** 2 for t in late])),
        "heat": abs(totals["mould.heat_in"] / size / EXACT.mould_heat(10.0) - 1),
        "interface": abs(totals["casting/mould.heat"] / totals["mould.heat_in"] - 1),
        "energy": totals["energy_error"],
    }


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
