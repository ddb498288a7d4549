"""A skin lets go of its wall by the pull of the whole skin, not by that of single nodes.

A cylinder freezes in a steel mould. At each time the pull that its wall bears, as a mean over the
wall, follows from the hoop stress of the skin and hardly hangs on the mesh, though those of
neighbouring nodes differ by more than the mean. It lets go at p_v (1 − w)/w.
"""

from __future__ import annotations

from itertools import takewhile
from typing import Any

import numpy as np
import pytest

from castx.proof.verification.states import nodal, places
from tests.coupled_cases import cylinder, simulation

SUCTION, COHERENCY, STEP = 1.01e5, 0.9, 0.1


def case(size: float) -> dict[str, Any]:
    data = cylinder(size=size)
    data["bodies"][0] = {
        "name": "casting", "material": "AlSi7Mg", "temperature": 670.0, "freezing": "cells",
        "law": "thermo-elasto-viscoplastic",
    }  # fmt: skip
    data["bodies"][1]["material"] = "steel-H13"
    data["time"] = {"end": 20.0, "fixed_step": STEP}
    return data


def pulls_until_it_opens(comm, size: float) -> list[float]:
    """Return the mean pulls over what the wall bears, of the steps until a pair opens."""
    ratios = []
    for state in simulation(comm, case(size)):
        if state.paired("casting/mould", "gap").max() > 1e-8:
            break
        force = state.problem.interfaces.states[0].force[:, 0]
        pull = -float(force.sum() / state.pairs["casting/mould"].areas.sum())
        wall = np.isclose(places(state, "casting")[:, 0], 0.03)
        solid = nodal(state, "casting", "solid_fraction")[wall].mean()
        share = max((solid - COHERENCY) / (1.0 - COHERENCY), 0.0)
        ratios.append(abs(pull) * share / (SUCTION * (1.0 - share)))
    return ratios


@pytest.mark.serial
@pytest.mark.parametrize("size", [5e-3, 2.5e-3])
def test_a_skin_is_held_until_its_mean_pull_is_what_the_wall_bears(comm, size):
    """It grows by a twelfth of what the wall bears in the last step."""
    held = pulls_until_it_opens(comm, size)
    assert 0.7 < held[-1] < 1.0
    assert np.all(np.diff(held[-5:]) > 0.0)


def box_of_few_cells(method: str) -> dict[str, Any]:
    """Return a box of three cells across, whose walls take much of its heat in each step."""
    flow = {"law": "garofalo", "creep_rate": 1e9, "breakdown_stress": 25e6, "exponent": 5.0,
            "activation_energy": 150e3}  # fmt: skip
    heat = {"law": "limited", "closed": 2470.0, "gas_conductivity": 0.0416, "transition": 2.51e-5}
    return {
        "geometry": {"generator": "box_in_mould", "model": "plane-strain",
                     "box": [0.0983, 0.09805], "wall": 0.084, "size": 0.039667},
        "materials": {"alloy": {"extends": "AlSi9Cu3", **flow}},
        "bodies": [{"name": "casting", "material": "alloy", "temperature": 669.6,
                    "law": "thermo-elasto-viscoplastic"},
                   {"name": "mould", "material": "Cu-pure", "temperature": 250.0}],
        "interfaces": [{"bodies": ["casting", "mould"], "contact": {"method": method},
                        "heat": heat}],
        "boundaries": [
            {"on": "mould/base", "displacement": {"normal": 0.0}},
            {"on": "mould/outside",
             "heat": {"type": "convection", "coefficient": 30.0, "ambient": 20.0}},
        ],
        "loads": {"gravity": [0.0, -9.81]},
        "time": {"end": 173.0},
    }  # fmt: skip


@pytest.mark.serial
def test_what_lets_go_in_a_pass_is_held_where_the_next_one_finds_it_liquid(comm):
    """Walls let go in passes whose heat is not that of the step, differently by each method."""
    gaps = []
    for method in ("condensed", "multipliers"):
        run = takewhile(lambda state: state.time < 75.0, simulation(comm, box_of_few_cells(method)))
        gaps.append([[state.time, state.paired("casting/mould", "gap").max()] for state in run])
    assert max(gap for _, gap in gaps[0]) > 1e-4
    np.testing.assert_allclose(gaps[0], gaps[1], rtol=1e-5, atol=1e-9)
