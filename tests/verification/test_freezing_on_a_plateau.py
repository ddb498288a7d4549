"""A plate of an alloy of which the last liquid freezes at one temperature, behind a front.

Reference: heat, with the enthalpy as unknown, and strain on a fine grid in one dimension, as
`test_freezing_in_cells` has them. Layers freeze there in many steps each. Where the mush bears
already as the front comes, the shrinkage of the front strains the skeleton; where coherency lies on
the plateau nothing bears ahead of the front, and liquid feeds it.
"""

from __future__ import annotations

from functools import cache
from itertools import islice
from typing import Any

from mpi4py import MPI

import numpy as np
import pytest
from scipy.linalg import solve_banded

from castx.arrays import FloatArray
from castx.proof.verification.solids.freezing_plate import MESHES, free_plate
from castx.proof.verification.states import nodal
from tests.coupled_cases import simulation
from tests.verification.test_freezing_in_cells import (
    CAPACITY,
    CONDUCTIVITY,
    DENSITY,
    EXPANSION,
    LATENT,
    LENGTH,
    SHRINKAGE,
    alloy,
    moduli,
    run,
)

COOLING, AMBIENT, START, END, STEPS = 4000.0, 250.0, 650.0, 40.0, 200
EUTECTIC, LAST = 548.0, 0.91
"""Temperature [°C] at which the alloy ends to freeze, and its solid fraction before that."""
FRACTIONS = [[EUTECTIC, 1.0], [EUTECTIC, LAST], [600.0, 0.75], [645.0, 0.0]]
FINE, SUBSTEPS = 960, 40


def case(mesh: str, cells: int, coherency: float) -> dict[str, Any]:
    """Return the plate with this number of cells across."""
    cooling = {"type": "convection", "coefficient": COOLING, "ambient": AMBIENT}
    return {
        **free_plate(*MESHES[mesh], LENGTH, cells, cooling),
        "materials": {"metal": alloy(FRACTIONS, coherency)},
        "bodies": [{"name": "casting", "material": "metal", "temperature": START,
                    "law": "thermo-elastic"}],
        "time": {"end": END, "fixed_step": END / STEPS},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-6},
    }  # fmt: skip


HOT = [*FRACTIONS, [700.0, 0.0]]
KNOTS = np.array([[0.0, 1.0], *HOT])
ENTHALPIES = DENSITY * (CAPACITY * KNOTS[:, 0] + LATENT * (1.0 - KNOTS[:, 1]))
STARTING = DENSITY * (CAPACITY * START + LATENT)


def temperatures(enthalpy: FloatArray) -> FloatArray:
    return np.asarray(np.interp(enthalpy, ENTHALPIES, KNOTS[:, 0]))


SIZE, STEP = LENGTH / FINE, END / STEPS / SUBSTEPS
CONDUCTS = CONDUCTIVITY / SIZE
VOLUMES = np.full(FINE + 1, SIZE)
VOLUMES[[0, -1]] *= 0.5


@cache
def heated() -> tuple[FloatArray, ...]:
    """Return the enthalpies of the fine grid before and after each of its steps [J/m³]."""
    found: list[FloatArray] = [np.full(FINE + 1, STARTING)]
    for _ in range(STEPS * SUBSTEPS):
        found.append(_heated(found[-1]))
    return tuple(found)


def _heated(start: FloatArray) -> FloatArray:
    """Return the enthalpies after an implicit Euler step, by Newton's method, damped."""

    def wrong(enthalpy: FloatArray) -> FloatArray:
        T = temperatures(enthalpy)
        flux = CONDUCTS * np.diff(T)
        gained = np.append(flux, 0.0) - np.append(0.0, flux)
        gained[0] += COOLING * (AMBIENT - T[0])
        return np.asarray(VOLUMES * (enthalpy - start) / STEP - gained)

    losses = np.full(FINE + 1, 2.0 * CONDUCTS)
    losses[[0, -1]] = CONDUCTS
    losses[0] += COOLING
    slopes = np.append(np.diff(KNOTS[:, 0]) / np.diff(ENTHALPIES), 0.0)
    enthalpy, residual = start, wrong(start)
    for _ in range(100):
        if np.abs(residual).max() < 1e-3:
            return enthalpy
        slope = slopes[np.searchsorted(ENTHALPIES, enthalpy, side="right") - 1]
        bands = np.zeros((3, FINE + 1))
        bands[1] = VOLUMES / STEP + losses * slope
        bands[0, 1:], bands[2, :-1] = -CONDUCTS * slope[1:], -CONDUCTS * slope[:-1]
        change, part = solve_banded((1, 1), bands, -residual), 1.0
        while part > 1e-3:
            found = wrong(enthalpy + part * change)
            if np.linalg.norm(found) < np.linalg.norm(residual):
                break
            part *= 0.5
        enthalpy, residual = enthalpy + part * change, found
    raise AssertionError("the heat of the reference has not converged")


@cache
def reference(coherency: float, *, held: bool) -> FloatArray:
    """Return the lateral strain at the ends of the steps, shape (steps,)."""
    fed = 1.0 if coherency >= LAST else coherency
    strain, strains = 0.0, []
    metals = (_metal(enthalpy, coherency, fed) for enthalpy in heated())
    w0, c0 = next(metals)
    for w1, c1 in metals:
        both, one = moduli(0.5 * (w0 + w1))
        if w1.any():
            pulled = VOLUMES @ (both * (c1 - c0)) / 3.0
            strain += float(pulled / (VOLUMES @ (one if held else both)))
        strains.append(strain)
        w0, c0 = w1, c1
    return np.array(strains[SUBSTEPS - 1 :: SUBSTEPS])


def _metal(enthalpy: FloatArray, coherency: float, fed: float) -> tuple[FloatArray, FloatArray]:
    """Return w and c of layers."""
    fraction = np.interp(enthalpy, ENTHALPIES, KNOTS[:, 1])
    share = np.clip((fraction - coherency) / (1.0 - coherency), 0.0, 1.0)
    cooled = np.minimum(temperatures(enthalpy), EUTECTIC) - EUTECTIC
    return share, 3.0 * EXPANSION * cooled - SHRINKAGE * np.maximum(fraction - fed, 0.0)


LATE = [STEPS // 2 - 1, 3 * STEPS // 4 - 1, STEPS - 1]


def off(comm, mesh: str, cells: int, coherency: float) -> FloatArray:
    """Return the errors of the contraction at a half, three quarters and the end."""
    exact = reference(coherency, held=MESHES[mesh][0] == "plane-strain")
    return np.asarray(np.abs(run(comm, case(mesh, cells, coherency))[0][LATE] / exact[LATE] - 1.0))


@pytest.mark.serial
@pytest.mark.sampled
@pytest.mark.parametrize("mesh", MESHES)
def test_a_front_behind_mush_that_bears_strains_the_skeleton(comm, mesh):
    """Its contraction goes with the logarithm of the skin, from what mush bears ahead of it."""
    coarse, fine = (off(comm, mesh, cells, 0.9) for cells in (10, 20))
    assert np.all(coarse[1:] < 0.2) and np.all(fine < 0.75 * coarse)


@pytest.mark.serial
@pytest.mark.sampled
@pytest.mark.parametrize("mesh", ["triangles", "quadrilaterals"])
def test_a_front_behind_mush_that_does_not_bear_is_fed(comm, mesh):
    """Coherency on the plateau: else each finer mesh would strain the first skin by more."""
    coarse, fine = (off(comm, mesh, cells, 0.95) for cells in (10, 20))
    assert np.all(coarse[1:] < 0.035) and np.all(fine < coarse)
    assert reference(0.9, held=True)[-1] < 1.5 * reference(0.95, held=True)[-1]


@pytest.mark.ranks
def test_a_run_goes_on_behind_the_front_as_if_it_had_not_stopped(comm):
    """In steps in which a front passes most of a cell, on any number of ranks."""
    data = case("triangles", 6, 0.9)
    data["time"] = {"end": 16.0, "fixed_step": 1.0}
    begun = simulation(comm, data)
    moved = [lateral(comm, state) for state in islice(begun, 12)]
    goes_on = simulation(comm, data)
    goes_on.restore({name: item.values for name, item in begun.saved().items()})
    rest = [lateral(comm, state) for state in begun]
    again = [lateral(comm, state) for state in goes_on]
    assert rest[-1] < 1.3 * moved[-1] < 0.0
    np.testing.assert_allclose(again[-len(rest) :], rest, rtol=1e-9)
    assert rest[-1] == pytest.approx(ON_ONE_RANK, rel=1e-6)
    for each in (begun, goes_on):
        each.destroy()


ON_ONE_RANK = -4.01278700807e-5
"""Lateral displacement at the end of that run [m]."""


def lateral(comm, state) -> float:
    """Return the most negative lateral displacement of all ranks [m]."""
    here = float(nodal(state, "casting", "displacement")[:, 1].min(initial=0.0))
    return float(comm.allreduce(here, op=MPI.MIN))
