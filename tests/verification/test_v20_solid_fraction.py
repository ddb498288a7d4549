"""V20 without mechanics: the solid fraction of the casting stands for the gap (Chiumenti, 9.2).

h(F_S) = F_S h_open + (1 − F_S) h_closed, F_S = (1/V) ∫ f_s dV. Shown are a slice of the cylinder
against a one-dimensional solution of its own (linear elements in the radius, lumped enthalpy, F_S
of the step before, small steps), and the whole cylinder beside the coupled run, whose gap gives
h_open: the law meets the end of solidification, which neither constant coefficient does.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.proof.verification.coupled.cylinder import reference, row, slice_case
from tests.coupled_cases import cylinder, merged, states

OPEN, CLOSED = 300.0, 2600.0
END, STEP = 20.0, 0.1


def by_solid_fraction(gap: float, solid: float) -> float:
    """Return the coefficient of the law [W/m²/K]."""
    return solid * OPEN + (1 - solid) * CLOSED


def thermal(data: dict, heat: dict, **time) -> dict:
    """Return a case without mechanics, with another law at its interface."""
    data = merged(data, {"coupling": {"scheme": "thermal"}, "time": time})
    data["interfaces"][0]["heat"] = heat
    return data


@pytest.mark.serial
def test_slice_follows_the_radial_solution(comm):
    law = {"law": "solid-fraction", "closed": CLOSED, "open": OPEN}
    data = thermal(slice_case(), law, end=END, fixed_step=STEP)
    rows = [row(state) for state in states(comm, data) if state.step > 0]
    time, *found, _, solid = np.transpose(rows)
    exact = reference(300, 0.01, time, END, by_solid_fraction)
    for name, history in zip(("centre", "surface", "mould"), found, strict=True):
        assert np.abs(history - exact[name])[time >= 2.0].max() < 2.5, name
    assert np.abs(solid - exact["solid"]).max() < 0.01
    assert solid[-1] > 0.5


def end_of_solidification(comm, data: dict) -> tuple[float, float]:
    """Return the time at which 98 % are solid, and the mean gap then."""
    rows = [
        (state.totals["casting.solid_fraction"], state.time, state.totals["casting/mould.mean_gap"])
        for state in states(comm, data)
    ]
    solid, time, gap = np.transpose(rows)
    assert solid[-1] > 0.98
    return float(np.interp(0.98, solid, time)), float(np.interp(0.98, solid, gap))


@pytest.mark.serial
def test_beside_the_coupled_run(comm):
    """Times of solidification: the law within 10 %, constant coefficients off by a quarter."""
    data = cylinder({"time": {"end": 75.0}}, size=0.005)
    heat = data["interfaces"][0]["heat"]
    coupled, gap = end_of_solidification(comm, data)
    opened = heat["gas_conductivity"] / gap
    law = {"law": "solid-fraction", "closed": heat["closed"], "open": opened}
    by_law, _ = end_of_solidification(comm, thermal(data, law))
    assert by_law == pytest.approx(coupled, rel=0.1)
    closed, _ = end_of_solidification(comm, thermal(data, {"law": "constant", "closed": 2300.0}))
    always_open, _ = end_of_solidification(
        comm, thermal(data, {"law": "constant", "closed": opened}, end=200.0)
    )
    assert closed < 0.8 * coupled
    assert always_open > 1.25 * coupled
