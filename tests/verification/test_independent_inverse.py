"""Interface and mould of a freezing bar by `castx identify` and by an inverse code without castx.

The other code is finite volumes of the enthalpy along the radius, explicit in time, with h linear
in ln between its knots, and `scipy.optimize.least_squares`. Both fit the same noisy curves of two
thermocouples in the mould, which the other code made on cells of half the size; h at two knots
and the conductivity of the mould are unknown. Asked is 1 % between both estimates.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares

from castx.input.toml_written import toml_text
from castx.studies.asked.identify import Identify
from castx.studies.inverse.identify import identify
from castx.studies.runs.runner import Runner
from tests.castx.studies.inverse.in_process import InProcess

pytestmark = pytest.mark.serial

RADIUS, OUTSIDE, END, NOISE = 0.02, 0.04, 10.0, 0.5
KNOTS = np.array([0.0, 10.0])
TRUTH = np.array([2000.0, 800.0, 35.0])
"""h at the knots [W/m²/K], conductivity of the mould [W/m/K]."""
FIRST = np.array([1700.0, 1000.0, 32.0])
DEPTHS = np.array([0.002, 0.008])
TIMES = np.arange(0.5, END + 0.1, 0.5)
CAPACITY, LATENT, SOLIDUS, LIQUIDUS, METAL = 2.6e6, 1.03e9, 557.0, 613.0, 150.0
MOULD_CAPACITY = 3.9e6


def metal_temperature(H):
    """Return the temperature of the metal from its enthalpy above the solidus [J/m³]."""
    mushy = SOLIDUS + H / (CAPACITY + LATENT / (LIQUIDUS - SOLIDUS))
    above = np.where(mushy < LIQUIDUS, mushy, SOLIDUS + (H - LATENT) / CAPACITY)
    return np.where(H < 0.0, SOLIDUS + H / CAPACITY, above)


def other_model(numbers, cells):
    """Return the temperatures at both depths over time, (2, times), by finite volumes."""
    h, k = numbers[:2], numbers[2]
    dr = RADIUS / cells
    faces = np.linspace(0.0, OUTSIDE, 2 * cells + 1)
    middles = 0.5 * (faces[1:] + faces[:-1])
    volumes = 0.5 * np.diff(faces**2)
    step = END / np.ceil(END / (0.4 * dr**2 * CAPACITY / METAL))
    H = np.full(cells, (670.0 - SOLIDUS) * CAPACITY + LATENT)
    T = np.concatenate([metal_temperature(H), np.full(cells, 200.0)])
    conductance = faces[1:-1] * np.where(middles[:-1] < RADIUS, METAL, k) / dr
    series = 0.5 * dr / METAL + 0.5 * dr / k
    at = 0.0
    kept = [np.full(2, 200.0)]
    times = [0.0]
    while at < END - 0.5 * step:
        now = np.exp(np.interp(at + 0.5 * step, KNOTS, np.log(h)))
        conductance[cells - 1] = RADIUS / (series + 1.0 / now)
        flow = np.concatenate([[0.0], conductance * (T[:-1] - T[1:]), [0.0]])
        gained = step * (flow[:-1] - flow[1:]) / volumes
        H = H + gained[:cells]
        T = np.concatenate([metal_temperature(H), T[cells:] + gained[cells:] / MOULD_CAPACITY])
        at += step
        times.append(at)
        kept.append(np.interp(RADIUS + DEPTHS, middles[cells:], T[cells:]))
    return np.array([np.interp(TIMES, times, curve) for curve in np.array(kept).T])


def other_estimate(measured):
    """Return the numbers that fit best by the other code."""

    def misfit(logarithms):
        return ((other_model(np.exp(logarithms), 30) - measured) / NOISE).ravel()

    found = least_squares(misfit, np.log(FIRST), diff_step=1e-3, xtol=1e-6)
    return np.exp(found.x)


def case_of():
    names = ("near", "far")
    place = {"body": "mould", "below": "casting/mould", "at": [RADIUS, 2.5e-4],
             "quantities": ["temperature"]}  # fmt: skip
    return {
        "geometry": {"generator": "cylinder_in_mould", "model": "axisymmetric",
                     "cells": "quadrilaterals", "radius": RADIUS, "height": 5e-4,
                     "wall": OUTSIDE - RADIUS, "size": 5e-4},
        "materials": {
            "metal": {"density": 2600.0, "heat_capacity": 1000.0, "conductivity": METAL,
                      "latent_heat": LATENT / 2600.0, "solidus": SOLIDUS, "liquidus": LIQUIDUS},
            "die": {"density": 7800.0, "heat_capacity": 500.0, "conductivity": 35.0},
        },
        "bodies": [{"name": "casting", "material": "metal", "temperature": 670.0},
                   {"name": "mould", "material": "die", "temperature": 200.0}],
        "interfaces": [{"bodies": ["casting", "mould"],
                        "heat": {"law": "constant", "closed": 1300.0}}],
        "coupling": {"scheme": "thermal"},
        "time": {"end": END, "fixed_step": 0.025},
        "output": {"fields": ["temperature"]},
        "probes": [{**place, "name": name, "depth": float(depth)}
                   for name, depth in zip(names, DEPTHS, strict=True)],
    }  # fmt: skip


@pytest.mark.slow
def test_both_codes_find_the_same(comm, tmp_path):
    noise = np.random.default_rng(3).normal(size=(2, len(TIMES)))
    measured = other_model(TRUTH, 60) + NOISE * noise
    table = np.column_stack([TIMES, *measured])
    np.savetxt(tmp_path / "t.csv", table, delimiter=",", header="time,near,far", comments="")
    other = other_estimate(measured)
    assert np.abs(np.log(other / TRUTH)).max() < 0.1
    h = {"of": "interfaces.0.heat.closed", "name": "h", "over": "time", "knots": KNOTS.tolist(),
         "start": FIRST[:2].tolist()}  # fmt: skip
    k = {"of": "materials.die.conductivity", "name": "k", "start": float(FIRST[2])}
    curves = [{"of": f"{name}.temperature", "file": "t.csv", "column": name, "noise": NOISE}
              for name in ("near", "far")]  # fmt: skip
    (tmp_path / "case.toml").write_text(toml_text(case_of()))
    (tmp_path / "study").mkdir()
    study = Identify.read({"curves": curves, "unknowns": [h, k]}).relative_to(tmp_path)
    runner = Runner(tmp_path / "case.toml", (), tmp_path / "study", InProcess(comm))
    result = identify(runner, study).found
    found = np.array([one.value for one in result.estimates])
    assert np.abs(np.log(found / other)).max() < 0.01, (found, other)
    held = [one.low < exact < one.high for one, exact in zip(result.estimates, TRUTH, strict=True)]
    assert sum(held) >= 2, found
