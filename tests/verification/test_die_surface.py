"""The surface of a thick die: behind an interface that suddenly conducts, and under periodic flux.

k = 28 W/m/K, ρc = 3.9e6 J/m³/K. Behind h = 8000 W/m²/K with 620 °C before it the surface of a
half-space of 200 °C rises by 420 K (1 - exp(a²) erfc(a)), a = h √(t/(kρc)).
A flux q cos ωt makes it swing by q/√(ωkρc), an eighth of a period behind.
Source: H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 1959, sections 2.7 and 2.9.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import erfcx

from castx.case.reading.read import read_case
from castx.command.run import RunSettings, run_case
from castx.results.reading import Results

CONDUCTIVITY, CAPACITY = 28.0, 3.9e6
COEFFICIENT, HOT, START = 8000.0, 620.0, 200.0
FLUX, PERIOD = 1e5, 60.0
STEEL = {"density": 7800.0, "heat_capacity": CAPACITY / 7800.0, "conductivity": CONDUCTIVITY}
PROBE = {"name": "surface", "at": [0.0, 0.0], "quantities": ["temperature"]}
STRIP = {"model": "plane-strain", "cells": "quadrilaterals", "width": 2e-3, "size": 2e-3}
THERMAL = {"coupling": {"scheme": "thermal"}}


def surface(comm, folder, case):
    """Return times and temperatures of the surface of a die in a run."""
    described = {**case, **THERMAL, "output": {"folder": str(folder / "out")}}
    case = read_case(described, folder / "die.toml")
    probes = Results(run_case(case, RunSettings(comm))).probes
    return probes["time"], probes["surface.temperature"]


def behind_an_interface(size):
    """Return a die that touches, behind an interface, what keeps its temperature."""
    reservoir = {"density": 1e6, "heat_capacity": 1e6, "conductivity": 1e6}
    return {
        "geometry": {"generator": "two_slabs", "length": 2e-3, "mould_length": 0.04,
                     "interface_size": size, **STRIP},
        "materials": {"steel": STEEL, "reservoir": reservoir},
        "bodies": [{"name": "casting", "material": "reservoir", "temperature": HOT},
                   {"name": "mould", "material": "steel", "temperature": START}],
        "interfaces": [{"bodies": ["casting", "mould"], "contact": {"method": "none"},
                        "heat": {"law": "constant", "closed": COEFFICIENT}}],
        "probes": [{**PROBE, "body": "mould"}],
        "time": {"end": 5, "first_step": 2e-4, "largest_step": 0.2, "temperature_change": 3},
    }  # fmt: skip


def on_a_surface(size, heat, time):
    """Return a die whose surface takes up heat."""
    return {
        "geometry": {"generator": "slab", "length": 0.08, "interface_size": size, **STRIP},
        "materials": {"steel": STEEL},
        "bodies": [{"name": "casting", "material": "steel", "temperature": START}],
        "boundaries": [{"on": "casting/wall", "heat": heat}],
        "probes": [{**PROBE, "body": "casting"}],
        "time": time,
    }


def film(size):
    """Return a die under convection with the coefficient of the interface."""
    heat = {"type": "convection", "coefficient": COEFFICIENT, "ambient": HOT}
    return on_a_surface(size, heat, behind_an_interface(size)["time"])


@pytest.mark.parametrize("die", [behind_an_interface, film])
def test_the_surface_of_a_half_space_warms_up(comm, shared_tmp_path, die):
    times, found = surface(comm, shared_tmp_path, die(5e-5))
    at = np.array([0.01, 0.1, 1.0, 5.0])
    ratio = COEFFICIENT * np.sqrt(at / (CONDUCTIVITY * CAPACITY))
    exact = START + (HOT - START) * (1.0 - erfcx(ratio))
    assert exact == pytest.approx([233.955, 293.970, 409.468, 498.178], abs=1e-3)
    assert np.interp(at, times, found) == pytest.approx(exact, abs=0.5)


def test_a_periodic_flux_makes_the_surface_swing(comm, shared_tmp_path):
    """First harmonic of the third period, beside a mean that still rises by what began it.

    Implicit Euler steps Δt delay √(iω) by ωΔt/4, and change its size in second order.
    """
    omega = 2.0 * np.pi / PERIOD
    course = np.linspace(0.0, 3.0 * PERIOD, 181)
    flux = np.column_stack([course, FLUX * np.cos(omega * course)]).tolist()
    time = {"end": 3.0 * PERIOD, "first_step": 1.0, "largest_step": 1.0, "fixed_step": 1.0}
    case = on_a_surface(1e-3, {"type": "flux", "value": flux}, time)
    times, found = surface(comm, shared_tmp_path, case)
    last = times > 2.0 * PERIOD + 1e-6
    phase = omega * times[last]
    columns = [np.cos(phase), np.sin(phase), np.ones(last.sum()), times[last] - times[last].mean()]
    real, imaginary = np.linalg.lstsq(np.column_stack(columns), found[last])[0][:2]
    amplitude = FLUX / np.sqrt(omega * CONDUCTIVITY * CAPACITY)
    assert amplitude == pytest.approx(29.57157, rel=1e-6)
    assert np.hypot(real, imaginary) == pytest.approx(amplitude, rel=0.003)
    assert np.arctan2(imaginary, real) == pytest.approx(np.pi / 4 + omega / 4, abs=0.005)
