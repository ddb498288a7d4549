"""A plate of an alloy that bears within a few kelvins, on few cells: freezing inside them.

Reference: heat and strain on a fine grid in one dimension. The metal is elastic, with w G and K/w
where a share w bears. New solid is born free of stress, nothing bends and no force acts along the
plate, so that with the volumetric strain c, thermal and of solidification,

    dε ∫ M dx = ∫ M dc/3 dx,   M = 18 K G w/(3 K + 4 w² G),

where both lateral directions move alike; where one of them is held, plane strain, the left-hand M
is 4 w G (3 K + w² G)/(3 K + 4 w² G).
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.linalg import solve_banded

from castx.arrays import FloatArray
from castx.proof.verification.solids.freezing_plate import MESHES, free_plate
from castx.proof.verification.states import nodal, places
from tests.coupled_cases import gone_on, simulation

LENGTH, BIOT_H, AMBIENT, START, END, STEPS = 0.02, 2000.0, 250.0, 640.0, 24.0, 240
DENSITY, CAPACITY, CONDUCTIVITY, LATENT = 2500.0, 1000.0, 100.0, 4e5
EXPANSION, SHRINKAGE, COHERENCY, POISSON = 2e-5, 0.05, 0.9, 0.3
FRACTIONS = [[594.0, 1.0], [600.0, 0.9], [606.0, 0.4], [630.0, 0.0]]
FINE = 480


def solid_fraction(temperature: FloatArray) -> FloatArray:
    temperatures, fractions = np.array(FRACTIONS).T
    return np.asarray(np.interp(temperature, temperatures, fractions))


def alloy(fractions: list[list[float]], coherency: float) -> dict[str, Any]:
    """Return the alloy that freezes by a table of solid fractions over temperatures [°C]."""
    return {
        "density": DENSITY, "heat_capacity": CAPACITY, "conductivity": CONDUCTIVITY,
        "latent_heat": LATENT, "solid_fraction": fractions, "young_modulus": 30e9,
        "poisson_ratio": POISSON, "expansion": EXPANSION, "solidification_shrinkage": SHRINKAGE,
        "liquid": {"viscosity": 1e4, "coherency": coherency},
    }  # fmt: skip


def case(mesh: str, cells: int, freezing: str) -> dict[str, Any]:
    """Return the plate with this number of cells across."""
    cooling = {"type": "convection", "coefficient": BIOT_H, "ambient": AMBIENT}
    return {
        **free_plate(*MESHES[mesh], LENGTH, cells, cooling),
        "materials": {"metal": alloy(FRACTIONS, COHERENCY)},
        "bodies": [{"name": "casting", "material": "metal", "temperature": START,
                    "law": "thermo-elastic", "freezing": freezing}],
        "time": {"end": END, "fixed_step": END / STEPS},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-6},
    }  # fmt: skip


def run(comm, data: dict[str, Any]) -> tuple[FloatArray, FloatArray]:
    """Return lateral strain and temperature of the wall [°C], both (steps,)."""
    width, strains, walls = data["geometry"]["width"], [], []
    for state in simulation(comm, data):
        if state.time == 0.0:
            continue
        place = places(state, "casting")
        top, wall = np.isclose(place[:, 1], width), np.isclose(place[:, 0], 0.0)
        strains.append(nodal(state, "casting", "displacement")[top, 1].mean() / width)
        walls.append(nodal(state, "casting", "temperature")[wall].mean())
    return np.array(strains), np.array(walls)


def fine_volumes() -> FloatArray:
    """Return the widths that belong to the nodes of a fine grid [m]."""
    found = np.full(FINE + 1, LENGTH / FINE)
    found[[0, -1]] *= 0.5
    return found


@cache
def fine_temperatures() -> list[FloatArray]:
    """Return the temperatures of its nodes [°C] at the start and after each step, (nodes,)."""
    size, step, volumes = LENGTH / FINE, END / STEPS, fine_volumes()
    found: list[FloatArray] = [np.full(FINE + 1, START)]
    for _ in range(STEPS):
        found.append(_heated(found[-1], volumes, CONDUCTIVITY / size, step))
    return found


@cache
def reference(*, held: bool) -> tuple[FloatArray, FloatArray]:
    """Return lateral strain and temperature of the wall [°C] on a fine grid, both (steps,)."""
    volumes, temperatures = fine_volumes(), fine_temperatures()
    strain, strains = 0.0, []
    for before, after in pairwise(temperatures):
        (w0, c0), (w1, c1) = metal(before), metal(after)
        w = 0.5 * (w0 + w1)
        both, one = moduli(w)
        if w.any():
            pulled = volumes @ (both * (c1 - c0)) / 3.0
            strain += float(pulled / (volumes @ (one if held else both)))
        strains.append(strain)
    return np.array(strains), np.array([each[0] for each in temperatures[1:]])


def moduli(share: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return M of layers that move in both lateral directions, and in one, over 2 G (1 + ν)."""
    G, K = 0.5 / (1.0 + POISSON), 1.0 / (3.0 * (1.0 - 2.0 * POISSON))
    scale = share / (3.0 * K + 4.0 * share**2 * G)
    return 18.0 * K * G * scale, 4.0 * G * (3.0 * K + share**2 * G) * scale


def metal(temperature: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return w and c of layers."""
    fraction = solid_fraction(temperature)
    share = np.clip((fraction - COHERENCY) / (1.0 - COHERENCY), 0.0, 1.0)
    cooled = np.minimum(temperature, FRACTIONS[0][0]) - FRACTIONS[0][0]
    beyond = np.maximum(fraction - COHERENCY, 0.0)
    return share, 3.0 * EXPANSION * cooled - SHRINKAGE * beyond


def _heated(start: FloatArray, volumes: FloatArray, conducts: float, step: float) -> FloatArray:
    """Return the temperatures after an implicit Euler step, by Newton's method."""

    def content(temperature: FloatArray) -> FloatArray:
        heat = CAPACITY * temperature - LATENT * solid_fraction(temperature)
        return np.asarray(DENSITY * volumes * heat)

    temperature, stored = start.copy(), content(start)
    for _ in range(200):
        flux = conducts * np.diff(temperature)
        gained = np.append(flux, 0.0) - np.concatenate([[0.0], flux])
        gained[0] += BIOT_H * (AMBIENT - temperature[0])
        wrong = (content(temperature) - stored) / step - gained
        slope = (content(temperature + 1e-4) - content(temperature - 1e-4)) / 2e-4 / step
        bands = np.zeros((3, len(start)))
        bands[1] = slope + np.concatenate([[BIOT_H], np.full(FINE, conducts)])
        bands[1, :-1] += conducts
        bands[0, 1:] = bands[2, :-1] = -conducts
        change = solve_banded((1, 1), bands, -wrong)
        temperature = temperature + change * min(1.0, 2.0 / np.abs(change).max())
        if np.abs(change).max() < 1e-9:
            return temperature
    raise AssertionError("the heat of the reference has not converged")


LATE = [3 * STEPS // 4 - 1, STEPS - 1]


OFF = {"triangles": 0.115, "quadrilaterals": 0.05, "tetrahedra": 0.115}
"""Bounds of the errors on ten cells; what quadrilaterals have is that of the temperatures."""


@pytest.mark.serial
@pytest.mark.sampled
@pytest.mark.parametrize("mesh", MESHES)
def test_a_plate_of_a_narrow_alloy_on_ten_cells(comm, mesh):
    """Its contraction at three quarters of the time and at the end; its wall while it freezes."""
    exact, wall = reference(held=MESHES[mesh][0] == "plane-strain")
    strains, walls = zip(
        *(run(comm, case(mesh, 10, freezing)) for freezing in ("cells", "nodes")), strict=True
    )
    inside, nodes = (np.abs(strain[LATE] / exact[LATE] - 1.0) for strain in strains)
    assert np.all(inside < OFF[mesh]) and np.all(nodes > 1.35 * inside)
    off, nodal_off = (np.sqrt(np.mean((found - wall)[STEPS // 10 :] ** 2)) for found in walls)
    assert off < 0.6 and nodal_off > 1.6 * off


@pytest.mark.serial
@pytest.mark.sampled
@pytest.mark.parametrize("cells", [10, 20])
def test_a_plate_of_quadratic_displacements(comm, cells):
    """By points of their own the skin in its cell is not strained: 30 and 14 % less contraction."""
    exact, _ = reference(held=True)
    data = case("triangles", cells, "cells")
    data["bodies"][0]["formulation"] = "taylor-hood"
    found, _ = run(comm, data)
    assert np.all(np.abs(found[LATE] / exact[LATE] - 1.0) < 0.045)


@pytest.mark.slow
@pytest.mark.serial
def test_both_come_closer_with_smaller_cells(comm):
    exact, _ = reference(held=False)
    for freezing in ("cells", "nodes"):
        coarse, fine = (
            np.abs(run(comm, case("tetrahedra", cells, freezing))[0][LATE] / exact[LATE] - 1.0)
            for cells in (10, 40)
        )
        assert np.all(fine < 0.5 * coarse)


@pytest.mark.ranks
def test_heat_is_kept_and_a_run_goes_on_as_if_it_had_not_stopped(comm):
    """In steps in which half of a cell freezes."""
    data = case("triangles", 6, "cells")
    data["time"] = {"end": 12.0, "fixed_step": 1.0}
    found, last = gone_on(comm, data)
    given = found[-1]["casting.enthalpy"] - found[0]["casting.enthalpy"]
    cooled = found[-1]["casting.mean_temperature"] - found[0]["casting.mean_temperature"]
    volume = LENGTH * data["geometry"]["width"]
    sensible = DENSITY * CAPACITY * cooled * volume
    solid = (sensible - given) / (DENSITY * LATENT * volume)
    assert found[-1]["casting.solid_fraction"] == pytest.approx(solid, rel=1e-6)
    lost = LATENT * DENSITY * LENGTH * data["geometry"]["width"]
    assert found[-1]["energy_error"] < 1e-6
    assert -found[-1]["casting/wall.heat"] > 0.3 * lost
    for name in ("casting/wall.heat", "casting.solid_fraction", "casting.enthalpy"):
        assert last[name] == pytest.approx(found[-1][name], rel=1e-9), name
