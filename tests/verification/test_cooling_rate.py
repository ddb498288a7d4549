"""Cooling rate, arm spacing and Niyama value at every node of a plate, those of its wall included.

A plate that conducts well cools as a whole: in the mush m dT/dt = -h (T - T_a)/L with
m = c + ΔH/ΔT_f, L half of its thickness, so that Ṫ at f = 0.9 is the same everywhere, 1.790 K/s
here. A plate with a gradient is compared with explicit finite volumes of 0.25 mm. Steps are those
of the program. Tolerance 1 %. The gradient at a surface is that of the cells inside it; so at the
wall, and at the centre where there is none, the Niyama value is that of the gradient found and the
exact rate.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from castx.case.reading.read import read_case
from castx.foundry.followed.foundry_fields import FoundryFields, poured_bodies, solidification_of
from castx.process.simulation import Simulation

pytestmark = pytest.mark.sampled

SOLIDUS, LIQUIDUS, START, AMBIENT = 560.0, 615.0, 640.0, 100.0
CAPACITY, LATENT, ARMS = 2.75e6, 9.8e8, 4e-5
MUSHY = CAPACITY + LATENT / (LIQUIDUS - SOLIDUS)
AT = LIQUIDUS - 0.9 * (LIQUIDUS - SOLIDUS)
HALF = 0.01
FIELDS = ["cooling_rate", "gradient", "niyama", "front_speed", "arm_spacing"]

MESHES = {
    "quadrilaterals": {"model": "plane-strain", "cells": "quadrilaterals", "size": 2e-3},
    "triangles": {"model": "plane-strain", "cells": "simplices", "size": 1e-3},
    "tetrahedra": {"model": "3d", "cells": "simplices", "size": 2e-3},
}


def found_in_plate(comm, name, coefficient, conductivity, end):
    """Return x and the fields of all nodes of half a plate, insulated at its centre."""
    mesh = MESHES[name]
    width = 2 * mesh["size"]
    depth = {"depth": width} if mesh["model"] == "3d" else {}
    alloy = {
        "density": 1000.0, "heat_capacity": CAPACITY / 1e3, "conductivity": conductivity,
        "latent_heat": LATENT / 1e3, "solidus": SOLIDUS, "liquidus": LIQUIDUS,
        "arm_spacing": {"coefficient": ARMS},
    }  # fmt: skip
    heat = {"type": "convection", "coefficient": coefficient, "ambient": AMBIENT}
    content = {
        "geometry": {"generator": "slab", "length": HALF, "width": width, **depth, **mesh},
        "materials": {"alloy": alloy},
        "bodies": [{"name": "casting", "material": "alloy", "temperature": START}],
        "boundaries": [{"on": "casting/wall", "heat": heat}],
        "time": {"end": end},
        "coupling": {"scheme": "thermal"},
        "output": {"fields": FIELDS},
    }
    case = read_case(content, Path("plate.toml"))
    simulation = Simulation.from_case(case, comm)
    solidification = solidification_of(case, simulation.mesh)
    fields = FoundryFields(solidification, poured_bodies(case))
    for state in simulation:
        solidification.update(state)
    body = simulation.mesh.bodies["casting"]
    owned = body.nodes.dofmap.index_map.size_local
    values = {name: fields.nodal("casting", name)[:owned] for name in FIELDS}
    values["x"] = body.points[:owned, 0]
    simulation.destroy()
    return {name: np.concatenate(comm.allgather(array)) for name, array in values.items()}


@cache
def reference(coefficient, conductivity, cells=40):
    """Return Ṫ and G over x at f = 0.9 of a plate, by explicit finite volumes of its half."""
    size = HALF / cells
    step = 0.4 * size**2 * CAPACITY / conductivity
    temperatures = np.array([0.0, SOLIDUS, LIQUIDUS, 1000.0])
    heights = CAPACITY * temperatures + LATENT * np.array([0.0, 0.0, 1.0, 1.0])
    enthalpy = np.full(cells, np.interp(START, temperatures, heights))
    rates, gradients = np.full(cells, np.nan), np.full(cells, np.nan)
    flux = np.zeros(cells + 1)
    before = np.full(cells, START)
    while np.isnan(rates).any():
        temperature = np.interp(enthalpy, heights, temperatures)
        resistance = 1.0 / coefficient + 0.5 * size / conductivity
        flux[0] = (temperature[0] - AMBIENT) / resistance
        flux[1:-1] = conductivity * np.diff(temperature) / size
        now = (before > AT) & (temperature <= AT)
        if now.any():
            rates[now] = -np.diff(flux)[now] / size / MUSHY
            gradients[now] = 0.5 * (flux[1:] + flux[:-1])[now] / conductivity
        before = temperature
        enthalpy = enthalpy + step / size * np.diff(flux)
    x = (np.arange(cells) + 0.5) * size
    return CubicSpline(x, rates), CubicSpline(x, gradients)


@pytest.mark.parametrize("name", MESHES)
def test_all_nodes_of_a_plate_that_conducts_well_cool_at_one_rate(comm, name):
    coefficient = 1.790 * MUSHY * HALF / (AT - AMBIENT)
    found = found_in_plate(comm, name, coefficient, 1e5, 60.0)
    np.testing.assert_allclose(found["cooling_rate"], 1.790, rtol=5e-3)
    np.testing.assert_allclose(found["arm_spacing"], ARMS * 1.790 ** (-1 / 3), rtol=2e-3)


@pytest.mark.ranks
@pytest.mark.parametrize("name", MESHES)
def test_a_plate_with_a_gradient_has_its_rates_at_every_node(comm, name):
    found = found_in_plate(comm, name, 200.0, 150.0, 200.0)
    rate, gradient = (of(found["x"]) for of in reference(200.0, 150.0))
    np.testing.assert_allclose(found["cooling_rate"], rate, rtol=0.01)
    np.testing.assert_allclose(found["arm_spacing"], ARMS * rate ** (-1 / 3), rtol=4e-3)
    x, size = found["x"], MESHES[name]["size"]
    inside = (x > 0.5 * size) & (x < HALF - 0.5 * size)
    exact = (gradient / np.sqrt(rate))[inside]
    np.testing.assert_allclose(found["niyama"][inside], exact, rtol=0.01)
    own = found["gradient"] / np.sqrt(rate)
    np.testing.assert_allclose(found["niyama"], own, rtol=5e-3)
    product = found["front_speed"] * found["gradient"]
    np.testing.assert_allclose(product, found["cooling_rate"], rtol=1e-12)
