"""Passing times where the melt rests on its liquidus: the insulated end of a slab, k = 0.9.

By Scheil's law with k = 0.9 half of the melt freezes within 1 K of the liquidus, so that its heat
flows at the liquidus, and the melt ahead comes near it as exp(-π² a t/(4 l²)). The slab of 20 mm is
cooled by 2000 W/m²/K to 25 °C and poured at 700 °C. Explicit finite volumes of 0.25 mm in numpy say
that its far end stays within 1.5 mK of the liquidus from 16.2 to 21.4 s: there the liquidus passes
in no sense that a measurement knows. A solid fraction of 1e-9 is reached after 17.9, 18.8 and
19.1 s with volumes of 0.5, 0.25 and 0.125 mm, one of 0.01 after 21.7, 21.9 and 22.0 s.

So the passing of the liquidus is bounded, and those of solid fractions from 0.001 on are compared:
tolerance 4.5 % from the middle to the end. The temperature of the end's own node passes f_s = 0.001
after 19.0 s, 11 % early, on ten elements. With k = 0.5 and 0.17 the end's tolerances are 7, 6, 4
and 2 % for solid fractions of 0.001, 0.01, 0.1 and 0.5, most of it the length of the usual steps.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.case.reading.read import read_case
from castx.foundry.front.solidification import Followed, Solidification
from castx.materials.lookup import find_material
from castx.process.simulation import Simulation

pytestmark = pytest.mark.sampled

LENGTH, COEFFICIENT, AMBIENT, START = 0.02, 2000.0, 25.0, 700.0
DENSITY, LATENT, C_SOLID, C_LIQUID, K_SOLID, K_LIQUID = 2600.0, 390e3, 1000.0, 1150.0, 180.0, 90.0
SOLIDUS, LIQUIDUS, MELTING = 548.0, 645.0, 660.0
FRACTIONS = (0.001, 0.01, 0.1, 0.5)
NEAR = 1.5e-3
"""Temperature over the liquidus at which the melt counts as resting on it [K]; below it f_s = 0.001
lies as far."""


@cache
def reference(partition: float) -> tuple[FloatArray, FloatArray, float]:
    """Return places [m], when `FRACTIONS` pass them, and when the end comes near the liquidus."""
    cells = 80
    mush = np.linspace(SOLIDUS, LIQUIDUS, 20001)
    melt = ((MELTING - mush) / (MELTING - LIQUIDUS)) ** (1.0 / (partition - 1.0))
    temperatures = np.concatenate([[0.0, SOLIDUS], mush, [1000.0]])
    solid = np.concatenate([[1.0, 1.0], 1.0 - melt, [0.0]])
    capacity = solid * C_SOLID + (1.0 - solid) * C_LIQUID
    rises = 0.5 * (capacity[1:] + capacity[:-1]) * np.diff(temperatures)
    heights = DENSITY * (np.append(0.0, np.cumsum(rises)) + LATENT * (1.0 - solid))
    size = LENGTH / cells
    step = 0.45 * size**2 * DENSITY * C_SOLID / K_SOLID
    widths: FloatArray = np.full(cells + 1, size)
    widths[[0, -1]] *= 0.5
    enthalpy: FloatArray = np.full(cells + 1, np.interp(START, temperatures[2:], heights[2:]))
    places: FloatArray = np.linspace(0.0, LENGTH, cells + 1, dtype=np.float64)
    times: FloatArray = np.full((len(FRACTIONS), cells + 1), np.nan)
    near, time = np.nan, 0.0
    flux = np.zeros(cells + 2)
    while np.isnan(times).any():
        temperature = np.interp(enthalpy, heights, temperatures)
        frozen = np.interp(enthalpy, heights, solid)
        for row, fraction in enumerate(FRACTIONS):
            times[row, np.isnan(times[row]) & (frozen >= fraction)] = time
        if np.isnan(near) and temperature[-1] < LIQUIDUS + NEAR:
            near = time
        conductivity = frozen * K_SOLID + (1.0 - frozen) * K_LIQUID
        between = 0.5 * (conductivity[1:] + conductivity[:-1])
        flux[1:-1] = -between * np.diff(temperature) / size
        flux[0] = -COEFFICIENT * (temperature[0] - AMBIENT)
        enthalpy -= step * np.diff(flux) / widths
        time += step
    return places, times, near


def passing_times(comm, partition, size, fractions):
    """Return x of the nodes and when solid fractions pass them."""
    alloy = {
        "density": DENSITY,
        "heat_capacity": {"solid": C_SOLID, "liquid": C_LIQUID},
        "conductivity": {"solid": K_SOLID, "liquid": K_LIQUID},
        "latent_heat": LATENT,
        "solidus": SOLIDUS,
        "liquidus": LIQUIDUS,
        "solid_fraction": "scheil",
        "partition_coefficient": partition,
        "melting_point": MELTING,
    }
    wall = {"type": "convection", "coefficient": COEFFICIENT, "ambient": AMBIENT}
    content = {
        "geometry": {
            "generator": "slab",
            "model": "plane-strain",
            "length": LENGTH,
            "width": size,
            "size": size,
            "cells": "quadrilaterals",
        },
        "materials": {"alloy": alloy},
        "bodies": [{"name": "casting", "material": "alloy", "temperature": START}],
        "boundaries": [{"on": "casting/wall", "heat": wall}],
        "time": {"end": 27.0},
        "coupling": {"scheme": "thermal"},
    }
    case = read_case(content, Path("slab.toml"))
    simulation = Simulation.from_case(case, comm)
    curve = find_material("alloy", case.materials).enthalpy
    followed = Followed(fractions=fractions)
    solidification = Solidification(simulation.mesh, {"casting": curve}, followed)
    for state in simulation:
        solidification.update(state)
    body = simulation.mesh.bodies["casting"]
    owned = body.nodes.dofmap.index_map.size_local
    found = solidification.of("casting")
    assert found is not None
    times = [found.passing_time(fraction)[:owned] for fraction in fractions]
    simulation.destroy()
    return tuple(np.concatenate(comm.allgather(v)) for v in (body.points[:owned, 0], *times))


@pytest.mark.parametrize("size", [2e-3, 1e-3, 0.5e-3])
def test_the_liquidus_passes_while_the_end_rests_on_it(size, comm):
    x, liquidus, *times = passing_times(comm, 0.9, size, (0.0, *FRACTIONS))
    places, exact, near = reference(0.9)
    inner = x > 0.5 * LENGTH - 1e-9
    for passing, expected in zip(times, exact, strict=True):
        exact_there = np.interp(x[inner], places, expected)
        np.testing.assert_allclose(passing[inner], exact_there, rtol=0.045)
    end = x > LENGTH - 1e-9
    assert (liquidus[end] > near).all()
    assert (liquidus[end] < 1.01 * exact[0, -1]).all()


@pytest.mark.parametrize("size", [2e-3, 1e-3, 0.5e-3])
@pytest.mark.parametrize("partition", [0.5, 0.17])
def test_later_fractions_pass_the_end_in_time(partition, size, comm):
    x, *times = passing_times(comm, partition, size, FRACTIONS)
    _, exact, _ = reference(partition)
    end = x > LENGTH - 1e-9
    errors = [passing[end] / there[-1] - 1.0 for passing, there in zip(times, exact, strict=True)]
    for error, tolerance in zip(errors, (0.07, 0.06, 0.04, 0.02), strict=True):
        np.testing.assert_allclose(error, 0.0, atol=tolerance)
