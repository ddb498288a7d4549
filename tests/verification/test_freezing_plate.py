"""V21: a plate contracts as it freezes, on few cells: its skin is one to four cells thick.

Reference: `castx/proof/verification/solids/freezing_plate.py`. The error comes and goes with the
place of the front in its cell, and this wave falls with their size.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from castx.proof.verification.solids.freezing_plate import (
    MESHES,
    PLATES,
    SETTLED,
    contraction,
    plate_case,
    reference,
)
from tests.coupled_cases import simulation

THIN, THICK = {8: (0.08, 0.05), 16: (0.04, 0.03)}, {8: (0.12, 0.08), 16: (0.06, 0.04)}
BOUNDS = {"thin wall": THIN, "die": THICK, "chill": THICK}
"""Of the error at half of the time and at the end, by the cells across the plate."""


def errors(comm, plate, mesh, cells, formulation="mixed"):
    """Return the relative error of the contraction, (steps,)."""
    data = plate_case(plate, *MESHES[mesh], cells)
    if formulation != "mixed":
        data["bodies"][0]["formulation"] = formulation
    exact = reference(plate)[1][1:]
    return contraction(simulation(comm, data), data)[1:] / exact - 1.0


@pytest.mark.sampled
@pytest.mark.serial
@pytest.mark.parametrize(
    "cells, mesh, name",
    [
        *((8, mesh, name) for mesh, name in zip(MESHES, PLATES, strict=True)),
        *((8, mesh, "chill") for mesh in ("triangles", "quadrilaterals")),
        (16, "tetrahedra", "thin wall"),
    ],
)
def test_a_plate_contracts_as_it_freezes(comm, cells, mesh, name):
    """In equal steps that follow the cells; each mesh with each plate is tried in default steps."""
    plate = replace(PLATES[name], steps=PLATES[name].steps * cells // 8)
    found = np.abs(errors(comm, plate, mesh, cells))
    at_half, at_end = BOUNDS[name][cells]
    assert found[plate.steps // 2 - 1] < at_half
    assert found[-1] < at_end


@pytest.mark.sampled
@pytest.mark.serial
@pytest.mark.parametrize("name", ["die", "thin wall", "chill"])
def test_a_plate_of_quadratic_displacements_contracts_as_it_freezes(comm, name):
    found = np.abs(errors(comm, PLATES[name], "triangles", 8, "taylor-hood"))
    at_half, at_end = BOUNDS[name][8]
    assert found[PLATES[name].steps // 2 - 1] < at_half
    assert found[-1] < at_end


@pytest.mark.sampled
@pytest.mark.serial
@pytest.mark.parametrize("name", PLATES)
@pytest.mark.parametrize("mesh", MESHES)
def test_a_plate_contracts_as_it_freezes_in_default_steps(comm, name, mesh):
    """On 16 cells, 30 to 46 steps: behind the thin wall up to 4.4 and 3.6 % off."""
    plate = PLATES[name]
    data = plate_case(plate, *MESHES[mesh], 16)
    data["time"] = {"end": data["time"]["end"]}
    times = []

    def states():
        for state in simulation(comm, data):
            times.append(state.time / data["time"]["end"])
            yield state

    strain = contraction(states(), data)
    found = np.interp([0.5, 1.0], times, strain)
    exact = reference(plate)[1][[plate.steps // 2, -1]]
    assert np.all(np.abs(found / exact - 1.0) < THICK[16])


@pytest.mark.slow
@pytest.mark.serial
def test_the_error_falls_with_the_size(comm):
    """By the first order at least, over all of the time in which the skin is some cells thick."""
    plate, found = PLATES["thin wall"], []
    time, exact = reference(plate)
    for cells in (8, 64):
        data = plate_case(plate, *MESHES["triangles"], cells)
        error = contraction(simulation(comm, data), data) - exact
        found.append(np.sqrt(np.mean(error[time >= SETTLED] ** 2)))
    assert found[1] < found[0] / 8
