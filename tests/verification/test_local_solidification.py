"""Local solidification time of an alloy with a eutectic end: chilled half-space, and plate.

f_s falls linearly from 1/2 at 560 °C to 0 at 615 °C, the other half freezes at 560 °C. Else it is
V3. Half-space with its wall at 300 °C, by similarity in η = x/√t: erf in the solid, erfc in the
liquid, in the mush (k T')' = -η/2 (c - L f_s') T' by Runge-Kutta; the eutectic front at η = a takes
k T'(a-) - k T'(a+) = a/2 L/2. So t_f = 8545.79 x² without eutectic, as V3 has it, 9057.15 x² with.
Plate of 2 · 10 mm, cooled by 3000 W/m²/K to 100 °C: explicit finite volumes of 0.125 mm in numpy.

Tolerance: 3 % where the stairs of a discrete front have become small against the distance, from the
sixth element behind the wall on quadrilaterals; in the plate everywhere, but for 7 % of the wall's
own nodes, which stand for half a volume, at ten elements from wall to centre. Right triangles carry
control volumes of two sizes, whose nodes scatter: 5 % each, 4 % the column's mean.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import erf, erfc

from castx.arrays import FloatArray
from castx.case.reading.read import read_case
from castx.foundry.front.solidification import Solidification
from castx.materials.lookup import find_material
from castx.process.simulation import Simulation

pytestmark = pytest.mark.sampled

SOLIDUS, LIQUIDUS, START, WALL = 560.0, 615.0, 640.0, 300.0
K_SOLID, K_LIQUID, C_SOLID, C_LIQUID, LATENT = 180.0, 85.0, 2.75e6, 2.70e6, 9.8e8
HALF, COEFFICIENT, AMBIENT = 0.01, 3000.0, 100.0


def fraction(temperature, eutectic):
    return (1.0 - eutectic) * (LIQUIDUS - temperature) / (LIQUIDUS - SOLIDUS)


@cache
def fronts(eutectic: float) -> tuple[float, float]:
    """Return x/√t of solidus and liquidus [m/√s] for a share of eutectic."""

    def mush(speed, state):
        temperature, flux = state
        solid = fraction(temperature, eutectic)
        conductivity = solid * K_SOLID + (1.0 - solid) * K_LIQUID
        capacity = solid * C_SOLID + (1.0 - solid) * C_LIQUID
        capacity += LATENT * (1.0 - eutectic) / (LIQUIDUS - SOLIDUS)
        return [flux / conductivity, -0.5 * speed * capacity * flux / conductivity]

    def reached(speed, state):
        return state[0] - LIQUIDUS

    reached.terminal = True  # type: ignore[attr-defined]

    def liquidus_front(solid_front):
        diffusivity = K_SOLID / C_SOLID
        steepness = (SOLIDUS - WALL) / erf(0.5 * solid_front / np.sqrt(diffusivity))
        flux = K_SOLID * steepness * np.exp(-(solid_front**2) / 4.0 / diffusivity)
        flux = flux / np.sqrt(np.pi * diffusivity) - 0.5 * solid_front * LATENT * eutectic
        found = solve_ivp(
            mush, (solid_front, 0.2), [SOLIDUS, flux], events=reached, rtol=1e-10, atol=1e-6
        )
        return (found.t_events[0][0], found.y_events[0][0][1]) if found.t_events[0].size else None

    def missing(solid_front):
        """Return the flux into the liquid less that out of the mush."""
        found = liquidus_front(solid_front)
        if found is None:
            return 1e9
        front, flux = found
        diffusivity = K_LIQUID / C_LIQUID
        drawn = K_LIQUID * (START - LIQUIDUS) * np.exp(-(front**2) / 4.0 / diffusivity)
        drawn /= np.sqrt(np.pi * diffusivity) * erfc(0.5 * front / np.sqrt(diffusivity))
        return drawn - flux

    guesses = np.linspace(5e-3, 1e-2, 40)
    values = np.array([missing(guess) for guess in guesses])
    place = int(np.flatnonzero((values[:-1] < 0.0) & (values[1:] > 0.0))[0])
    solid_front = brentq(missing, guesses[place], guesses[place + 1], xtol=1e-13)
    return solid_front, liquidus_front(solid_front)[0]


@dataclass(frozen=True)
class Passing:
    """When solidus and liquidus pass the places of the plate, counted from its wall [m, s]."""

    solidus: tuple[FloatArray, FloatArray]
    liquidus: tuple[FloatArray, FloatArray]

    def local_time(self, x):
        """Return the local solidification time at places [s]."""
        return np.interp(x, *self.solidus) - np.interp(x, *self.liquidus)


@cache
def plate() -> Passing:
    """Return when the fronts pass the plate.

    The solidus stands where the eutectic that has frozen so far ends, the liquidus at the centre
    of a cell whose temperature it is, and both at the wall when its surface has their temperature.
    """
    cells = 80
    mush = np.linspace(SOLIDUS, LIQUIDUS, 2001)
    solid = np.concatenate([[1.0, 1.0], fraction(mush, 0.5), [0.0]])
    temperatures = np.concatenate([[0.0, SOLIDUS], mush, [1000.0]])
    capacity = solid * C_SOLID + (1.0 - solid) * C_LIQUID
    conductivity = solid * K_SOLID + (1.0 - solid) * K_LIQUID

    def integral(values):
        rises = 0.5 * (values[1:] + values[:-1]) * np.diff(temperatures)
        return np.concatenate([[0.0], np.cumsum(rises)])

    heights, potentials = integral(capacity) + LATENT * (1.0 - solid), integral(conductivity)
    eutectic = heights[2] - heights[1]
    size = HALF / cells
    step = 0.4 * size**2 * C_LIQUID / K_SOLID
    enthalpy: FloatArray = np.full(cells, np.interp(START, temperatures[2:], heights[2:]))
    liquid = np.full(cells, np.nan)
    walls, moments, ends = [], [], []
    time = 0.0
    flux = np.zeros(cells + 1)
    while enthalpy[-1] > heights[1]:
        potential = np.interp(enthalpy, heights, potentials)
        flux[1:-1] = np.diff(potential) / size
        surface = np.interp(potential[0], potentials, temperatures)
        resistance = 0.5 * size / np.interp(surface, temperatures, conductivity)
        flux[0] = (surface - AMBIENT) / (1.0 / COEFFICIENT + resistance)
        walls.append(AMBIENT + flux[0] / COEFFICIENT)
        moments.append(time)
        ends.append(size * np.clip((heights[2] - enthalpy) / eutectic, 0.0, 1.0).sum())
        new = enthalpy + step / size * np.diff(flux)
        now = (enthalpy > heights[-2]) & (new <= heights[-2])
        liquid[now] = time + step * (enthalpy[now] - heights[-2]) / (enthalpy - new)[now]
        enthalpy, time = new, time + step
    begun, ended = (moments[np.argmax(np.array(walls) <= level)] for level in (LIQUIDUS, SOLIDUS))
    behind = np.array(ends) > 0.25 * size
    return Passing(
        (np.append(0.0, np.array(ends)[behind]), np.append(ended, np.array(moments)[behind])),
        (np.append(0.0, (np.arange(cells) + 0.5) * size), np.append(begun, liquid)),
    )


def followed(comm, eutectic, size, length, end, wall, cells, step=None):
    """Return x, local solidification time and Niyama value of the nodes."""
    rows = [[SOLIDUS, 1.0], [SOLIDUS, 1.0 - eutectic], [LIQUIDUS, 0.0]]
    alloy = {
        "density": 1000.0,
        "heat_capacity": {"solid": C_SOLID / 1e3, "liquid": C_LIQUID / 1e3},
        "conductivity": {"solid": K_SOLID, "liquid": K_LIQUID},
        "latent_heat": LATENT / 1e3,
        "solid_fraction": rows[eutectic == 0.0 :],
    }
    content = {
        "geometry": {
            "generator": "slab",
            "model": "plane-strain",
            "length": length,
            "width": 4 * size,
            "size": size,
            "cells": cells,
        },
        "materials": {"alloy": alloy},
        "bodies": [{"name": "casting", "material": "alloy", "temperature": START}],
        "boundaries": [{"on": "casting/wall", "heat": wall}],
        "time": {"end": end},
        "coupling": {"scheme": "thermal"},
    }
    if step is not None:
        content["time"] |= {"first_step": step, "largest_step": step, "fixed_step": step}
    case = read_case(content, Path("chilled.toml"))
    simulation = Simulation.from_case(case, comm)
    curve = find_material("alloy", case.materials).enthalpy
    solidification = Solidification(simulation.mesh, {"casting": curve})
    for state in simulation:
        solidification.update(state)
    owned = simulation.mesh.bodies["casting"].nodes.dofmap.index_map.size_local
    x = simulation.mesh.bodies["casting"].points[:owned, 0]
    found = [
        solidification.nodal("casting", name)[:owned] for name in ("solidification_time", "niyama")
    ]
    simulation.destroy()
    return tuple(np.concatenate(comm.allgather(values)) for values in (x, *found))


def columns(x, values, size):
    """Return means of the columns of nodes across the strip."""
    number = np.rint(x / size).astype(int)
    return np.array([values[number == column].mean() for column in np.unique(number)])


CHILLED = {"type": "temperature", "value": WALL}


def test_the_similarity_solution_has_the_constant_of_v3():
    solidus, liquidus = fronts(0.0)
    assert 1.0 / solidus**2 - 1.0 / liquidus**2 == pytest.approx(8545.79, rel=1e-5)


@pytest.mark.parametrize("eutectic", [0.0, 0.5])
@pytest.mark.parametrize("size", [1e-3, 0.5e-3])
@pytest.mark.parametrize("cells", ["quadrilaterals", "simplices"])
def test_few_elements_behind_a_chilled_wall(eutectic, size, cells, comm):
    step = 0.02 * (size / 1e-3) ** 2
    x, times, _ = followed(comm, eutectic, size, 40 * size, 150 * step, CHILLED, cells, step)
    solidus, liquidus = fronts(eutectic)
    constant = 1.0 / solidus**2 - 1.0 / liquidus**2
    here = (x > 5.5 * size) & (x < 10.5 * size)
    errors = times[here] / (constant * x[here] ** 2) - 1.0
    mean, largest = np.abs(columns(x[here], errors, size)).max(), np.abs(errors).max()
    assert mean < (0.03 if cells == "quadrilaterals" else 0.04)
    assert largest < (0.03 if cells == "quadrilaterals" else 0.05)


@pytest.mark.parametrize("size", [1e-3, 0.5e-3])
@pytest.mark.parametrize("step", [0.05, None])
def test_a_plate_freezes_from_its_wall_to_its_centre(size, step, comm):
    wall = {"type": "convection", "coefficient": COEFFICIENT, "ambient": AMBIENT}
    x, times, _ = followed(comm, 0.5, size, HALF, 14.0, wall, "quadrilaterals", step)
    errors = columns(x, np.abs(times / plate().local_time(x) - 1.0), size)
    assert errors[0] < (0.07 if size > 0.5e-3 else 0.03)
    assert errors[1:].max() < 0.03
    assert errors[-1] < 0.01


def test_a_front_that_passes_several_nodes_in_a_step_has_a_niyama_value(comm):
    """Steps of 0.2 s, in which the front goes on by three elements first, at last by half a one.

    In the first step all heat leaves at one rate, so that nodes pass one soon after the other.
    """
    size = 1e-3
    _, _, fine = followed(comm, 0.5, size, 0.04, 1.8, CHILLED, "quadrilaterals", 0.01)
    x, _, coarse = followed(comm, 0.5, size, 0.04, 1.8, CHILLED, "quadrilaterals", 0.2)
    here = (x > 0.5 * size) & (x < 7.5 * size)
    ratio = columns(x[here], coarse[here] / fine[here], size)
    assert np.abs(ratio[2:] - 1.0).max() < 0.1
    assert ratio[:2].min() > 0.45
