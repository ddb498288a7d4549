"""Time in which the fastest node changes, beside h ΔT over the heat of half a cell."""

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.process.building import SMALLEST, step_settings
from castx.process.simulation import Simulation

SIZE, CLOSED, HOT, COLD, CHANGE = 5e-3, 800.0, 900.0, 300.0, 20.0
METAL = {
    "density": 7000.0, "heat_capacity": 600.0, "conductivity": 30.0, "latent_heat": 2e5,
    "solidus": 895.0, "liquidus": 899.0,
}  # fmt: skip
SAND = {"density": 1600.0, "heat_capacity": 1000.0, "conductivity": 0.6}


def case(tmp_path, **time):
    """Return a plate of metal that has just come into sand, in one dimension."""
    content = {
        "geometry": {
            "generator": "two_slabs", "model": "plane-strain", "length": 0.05, "size": SIZE,
            "mould_length": 0.05, "width": 0.01, "cells": "quadrilaterals",
        },
        "materials": {"iron": METAL, "sand": SAND},
        "bodies": [
            {"name": "casting", "material": "iron", "temperature": HOT},
            {"name": "mould", "material": "sand", "temperature": COLD},
        ],
        "interfaces": [
            {"bodies": ["casting", "mould"], "heat": {"law": "constant", "closed": CLOSED}}
        ],
        "coupling": {"scheme": "thermal"},
        "time": {"end": "8 h", "temperature_change": CHANGE, **time},
    }  # fmt: skip
    return read_case(content, tmp_path / "case.toml")


EXACT = 1600.0 * 1000.0 * SIZE / 2 * CHANGE / (CLOSED * (HOT - COLD))  # of the sand: 0.17 s


@pytest.mark.ranks
def test_the_first_step_follows_from_the_heat_that_crosses_the_interface(comm, shared_tmp_path):
    """Of the sand at the interface, which is lighter; latent heat delays nothing."""
    simulation = Simulation.from_case(case(shared_tmp_path), comm)
    assert simulation.problem.time_to_change(CHANGE) == pytest.approx(EXACT, rel=1e-9)
    states = iter(simulation)
    next(states)
    first = next(states)
    assert first.time == pytest.approx(EXACT, rel=0.05)  # two digits of it
    left = first.nodal("mould", "temperature")
    risen = comm.allreduce(float(left.max()), op=max)
    assert COLD + 0.4 * CHANGE < risen < COLD + CHANGE
    assert first.totals["casting.solid_fraction"] < 0.01
    simulation.destroy()


@pytest.mark.serial
def test_steps_that_the_case_gives_stay(tmp_path):
    given = step_settings(case(tmp_path, first_step=5.0, smallest_step=0.5), EXACT)
    assert (given.first, given.smallest) == (5.0, 0.5)
    found = step_settings(case(tmp_path, smallest_step=20.0), EXACT)
    assert (found.first, found.smallest) == (0.17, 0.17)
    calm = step_settings(case(tmp_path), np.inf)
    assert (calm.first, calm.smallest) == (pytest.approx(29.0), pytest.approx(29.0 * SMALLEST))
