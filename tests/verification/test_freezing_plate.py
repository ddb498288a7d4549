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


def errors(comm, plate, mesh, cells):
    """Return the relative error of the contraction, (steps,)."""
    data = plate_case(plate, *MESHES[mesh], cells)
    exact = reference(plate)[1][1:]
    return contraction(simulation(comm, data), data)[1:] / exact - 1.0


@pytest.mark.sampled
@pytest.mark.serial
@pytest.mark.parametrize("name", PLATES)
@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("cells", [8, 16])
def test_a_plate_contracts_as_it_freezes(comm, name, mesh, cells):
    """In steps that follow the cells."""
    plate = replace(PLATES[name], steps=PLATES[name].steps * cells // 8)
    found = np.abs(errors(comm, plate, mesh, cells))
    at_half, at_end = BOUNDS[name][cells]
    assert found[plate.steps // 2 - 1] < at_half
    assert found[-1] < at_end


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
