"""V20 without mechanics: the solid fraction of the casting stands for the gap (Chiumenti, 9.2).

h(F_S) = F_S h_open + (1 − F_S) h_closed, F_S = (1/V) ∫ f_s dV. Shown are a slice of the cylinder
against a one-dimensional solution of its own (linear elements in the radius, lumped enthalpy, F_S
of the step before, small steps), and the whole cylinder beside the coupled run, whose gap gives
h_open: the law meets the end of solidification, which neither constant coefficient does.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import solve_banded

from tests.coupled_cases import cylinder, merged, states
from tests.verification.test_v20_slice import (
    CAPACITY,
    CONDUCTIVITY,
    DENSITY,
    LATENT,
    MELT,
    MOULD,
    POUR,
    RADIUS,
    START,
    WALL,
    Cylinder1D,
    case,
    temperature_of,
)

OPEN, CLOSED = 300.0, 2600.0
END, STEP = 20.0, 0.1


def reference(cells: int, step: float, times: np.ndarray) -> dict[str, np.ndarray]:
    """Return histories: temperatures of centre and of both surfaces, and F_S."""
    metal = Cylinder1D(np.linspace(0.0, RADIUS, cells + 1))
    die = Cylinder1D(RADIUS + WALL * np.linspace(0.0, 1.0, cells + 1) ** 1.5)
    n, c_die = cells + 1, MOULD["density"] * MOULD["heat_capacity"]
    volume = np.concatenate((metal.volume, die.volume))
    H = np.concatenate((np.full(n, DENSITY * (LATENT + CAPACITY * (POUR - MELT))),
                        np.full(n, START * c_die)))  # fmt: skip
    die_bands = die.conduction(np.full(cells, MOULD["conductivity"]))
    rows = []
    for _ in range(round(END / step)):
        old = H.copy()
        fraction = temperature_of(H[:n])[2]
        solid = metal.volume @ fraction / metal.volume.sum()
        h = RADIUS * (solid * OPEN + (1 - solid) * CLOSED)
        for _ in range(40):
            T, slope, fraction = temperature_of(H[:n])
            k = CONDUCTIVITY[0] * fraction + CONDUCTIVITY[1] * (1 - fraction)
            bands = np.zeros((3, 2 * n))
            bands[:, :n] = metal.conduction((k[1:] + k[:-1]) / 2)
            bands[:, n:] = die_bands
            bands[1, n - 1] += h
            bands[1, n] += h
            bands[0, n] -= h
            bands[2, n - 1] -= h
            both = np.concatenate((T, H[n:] / c_die))
            balance = volume * (H - old) / step + bands[1] * both
            balance[:-1] += bands[0, 1:] * both[1:]
            balance[1:] += bands[2, :-1] * both[:-1]
            if np.abs(balance).max() < 1e-9 * np.abs(volume * H).max() / step:
                break
            matrix = bands * np.concatenate((slope, np.full(n, 1 / c_die)))
            matrix[1] += volume / step
            H = H - solve_banded((1, 1), matrix, balance)
        T, _, fraction = temperature_of(H[:n])
        solid = metal.volume @ fraction / metal.volume.sum()
        rows.append((T[0], T[-1], H[n] / c_die, solid))
    time = step * np.arange(1, len(rows) + 1)
    names = ("centre", "surface", "mould", "solid")
    histories = zip(names, np.transpose(rows), strict=True)
    return {name: np.interp(times, time, history) for name, history in histories}


def thermal(data: dict, heat: dict, **time) -> dict:
    """Return a case without mechanics, with another law at its interface."""
    data = merged(data, {"coupling": {"scheme": "thermal"}, "time": time})
    data["interfaces"][0]["heat"] = heat
    return data


@pytest.mark.serial
def test_slice_follows_the_radial_solution(comm):
    law = {"law": "solid-fraction", "closed": CLOSED, "open": OPEN}
    rows = []
    for state in states(comm, thermal(case(), law, end=END, fixed_step=STEP)):
        if state.step == 0:
            continue
        casting, mould = (state.mesh.bodies[name].points for name in ("casting", "mould"))
        T, T_mould = state.nodal("casting", "temperature"), state.nodal("mould", "temperature")
        on_axis, surface = casting[:, 0] == 0.0, casting[:, 0] > RADIUS * (1 - 1e-9)
        inside = mould[:, 0] < RADIUS * (1 + 1e-9)
        rows.append((state.time, T[on_axis].mean(), T[surface].mean(), T_mould[inside].mean(),
                     state.totals["casting.solid_fraction"]))  # fmt: skip
    time, *found = np.transpose(rows)
    exact = reference(300, 0.01, time)
    for name, history in zip(("centre", "surface", "mould"), found, strict=False):
        assert np.abs(history - exact[name])[time >= 2.0].max() < 2.5, name
    assert np.abs(found[3] - exact["solid"]).max() < 0.01
    assert found[3][-1] > 0.5


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
