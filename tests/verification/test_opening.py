"""Opening the mould: residual stress is in balance with itself, and nothing holds the casting.

A casting that has flowed in its mould, or round a core, is set free. On a free body the virtual
work of the stress vanishes for every motion: what cells exert on a node is balanced by other cells
there, at all nodes. Stresses are not zero: they are residual.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.domain.measures import nodal_mean, nodal_volumes
from tests.coupled_cases import ALUMINIUM, STEEL, cylinder, ring, simulation

FLOWING = {
    "solidus": 640.0,
    "yield_stress": [[20.0, 60e6], [640.0, 1e6]],
    "hardening": 500e6,
    "viscosity": 1e8,
}
LIQUID = {"liquid": {"model": "viscous", "viscosity": 1e6, "coherency": 0.6}}
COLD = {"type": "convection", "coefficient": 2000.0, "ambient": 20.0}
TIGHT = {"linear": "direct", "mechanics_tolerance": 1e-9}


def opened_cylinder() -> dict[str, Any]:
    """Return a cylinder whose core is still liquid when the mould is opened and water cools it."""
    data = cylinder({"materials": {"aluminium": {**FLOWING, **LIQUID}}}, size=0.0075)
    data["bodies"][0]["law"] = "thermo-elasto-viscoplastic"
    wet = {"on": "casting/mould", "heat": COLD}
    free = {"on": "casting/base", "displacement": "free"}
    data["stages"] = [{"at": 30.0, "remove": ["mould"], "boundaries": [wet, free]}]
    data["time"] = {"end": 50.0, "first_step": 0.1, "largest_step": 5.0}
    return data


def ring_off_its_core() -> dict[str, Any]:
    """Return a ring that has shrunk onto a core and yielded; the core is drawn."""
    data = ring({"materials": {"aluminium": FLOWING}})
    data["bodies"][0]["law"] = "thermo-elasto-plastic"
    free = {"on": "casting/base", "displacement": "free"}
    data["stages"] = [{"at": 45.0, "remove": ["core"], "eject": 0.2, "boundaries": [free]}]
    data["time"] = {"end": 50.0, "first_step": 0.1, "largest_step": 5.0}
    return data


def box() -> dict[str, Any]:
    """Return a box of hexahedra in space that nothing at all holds once the mould is gone."""
    metal = {**ALUMINIUM, **FLOWING, "liquidus": 645.0}
    hot = {"type": "convection", "coefficient": 1000.0, "ambient": 20.0}
    return {
        "geometry": {"generator": "box_in_mould", "model": "3d", "box": [0.05, 0.04, 0.03],
                     "wall": 0.02, "size": 0.014, "cells": "quadrilaterals"},
        "materials": {"aluminium": metal, "steel": STEEL},
        "bodies": [
            {"name": "casting", "material": "aluminium", "temperature": 650.0,
             "law": "thermo-elasto-plastic"},
            {"name": "mould", "material": "steel", "temperature": 200.0,
             "formulation": "displacement"},
        ],
        "interfaces": [{"bodies": ["casting", "mould"],
                        "heat": {"law": "limited", "closed": 3000.0, "gas_conductivity": 0.05}}],
        "boundaries": [{"on": "mould/base", "displacement": {"all": 0.0}}],
        "stages": [{"at": 15.0, "remove": ["mould"], "boundaries": [
            {"on": "casting/mould", "heat": hot}]}],
        "time": {"end": 25.0, "first_step": 0.5, "largest_step": 5.0, "temperature_change": 60.0},
    }  # fmt: skip


def balance(comm, state) -> tuple[float, float]:
    """Return the largest force on a node, relative to all that cells exert, and the mean stress."""
    body = state.problem.mechanics.bodies["casting"]
    forces = body.residual().reshape(-1, body.block_size)[:, : body.dimension].copy()
    if state.mesh.model == "axisymmetric":
        on_axis = body.mesh.points[: len(forces), 0] < 1e-9
        forces[on_axis, 0] = 0.0
    scale = np.sqrt(comm.allreduce(body.force_scale()[0]))
    largest = max(comm.allgather(float(np.abs(forces).max(initial=0.0))))
    nodes = nodal_volumes(body.mesh, state.mesh.model)
    stress = nodal_mean(body.mesh, state.cellwise("casting", "von_mises"))[: len(nodes)]
    mean = comm.allreduce(float(nodes @ stress)) / comm.allreduce(float(nodes.sum()))
    return largest / scale, mean


@pytest.mark.sampled
@pytest.mark.parametrize(
    "case",
    [
        pytest.param(opened_cylinder, marks=pytest.mark.serial),
        ring_off_its_core,
        pytest.param(box, marks=pytest.mark.serial),
    ],
)
def test_residual_stress_is_in_balance_with_itself(comm, case):
    data = case() | {"solver": TIGHT}
    removed = data["bodies"][1]["name"]
    cutbacks, at_once = 0, None
    for state in (run := simulation(comm, data)):
        totals = state.totals
        cutbacks += state.counters.cutbacks
        if state.time == data["stages"][0]["at"]:
            before = totals
            held = balance(comm, state)
        if state.process.stage == 1 and at_once is None:
            at_once = balance(comm, state)
    for force, stress in (at_once, balance(comm, state)):
        assert force < 1e-6
        assert stress > 5e4
    forces = [value for name, value in totals.items() if f"casting/{removed}.force" in name]
    assert len(forces) == state.mesh.parent.geometry.dim and not any(forces)
    assert totals["support_force"] < 1e-6 * np.sqrt(
        comm.allreduce(state.problem.mechanics.bodies["casting"].force_scale()[0])
    )
    assert totals["energy_error"] < 1e-6
    assert state.process.events[0]["time"] == data["stages"][0]["at"]
    if case is ring_off_its_core:
        assert before["core.ejection_force"] > 1e3
        assert held[0] > 1e-2, "the core held the ring before"
    assert cutbacks == 0
    run.destroy()
