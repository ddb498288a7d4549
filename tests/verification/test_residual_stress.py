"""Residual stress of castings with their real material: what equilibrium and energy demand of it.

There is no reference. A body on which no force acts has stresses whose means over its volume are
zero (the virtual work of every linear displacement), and the heat of plastic work is in the ledger.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.coupled_cases import merged, simulation

METAL = {
    "extends": "AlSi7Mg",
    "hardening": {"linear": 2e8},
}
TIGHT = {"solver": {"linear": "direct", "mechanics_tolerance": 1e-9, "heat_tolerance": 1e-10}}


def cylinder(*changes: dict[str, Any], law: str = "thermo-elasto-viscoplastic") -> dict[str, Any]:
    """Return a cylinder that freezes in a cold steel mould and cools in it."""
    data = {
        "geometry": {"generator": "cylinder_in_mould", "model": "axisymmetric",
                     "radius": 0.03, "height": 0.05, "wall": 0.02, "size": 0.005},
        "materials": {"alloy": METAL},
        "bodies": [
            {"name": "casting", "material": "alloy", "temperature": 660.0, "law": law},
            {"name": "mould", "material": "steel-H13", "temperature": 150.0,
             "formulation": "displacement"},
        ],
        "interfaces": [{"bodies": ["casting", "mould"],
                        "heat": {"law": "limited", "closed": 4000.0, "gas_conductivity": 0.3}}],
        "boundaries": [
            {"on": "casting/base", "displacement": {"normal": 0.0}},
            {"on": "mould/base", "displacement": {"normal": 0.0}},
            {"on": "casting/top", "heat": {"type": "convection", "coefficient": 300.0,
                                           "ambient": 20.0}},
            {"on": "mould/outside", "heat": {"type": "convection", "coefficient": 1000.0,
                                             "ambient": 20.0}},
        ],
        "time": {"end": 400.0, "first_step": 0.1, "largest_step": 40.0, "smallest_step": 1e-3,
                 "temperature_change": 30.0},
    }  # fmt: skip
    for change in changes:
        data = merged(data, change)
    return data


def stress_means(comm, state) -> tuple[np.ndarray, float]:
    """Return the means of σ_zz and of σ_rr + σ_θθ, and that of the stress's size [Pa].

    The pressure is integrated as it is, linear in the cells and with the radius as weight.
    """
    body = state.problem.mechanics.bodies["casting"]
    owned = body.owned_cells
    cells = body.points.weights.sum(axis=1)[:owned]
    stress = body.stress()[:owned]
    rr, zz, around = body.material.response.stress[:owned, :3].T
    nodes = state.problem.volumes["casting"]
    pressure = nodes @ body.nodal_pressure()[: len(nodes)]
    size = cells @ np.linalg.norm(stress, axis=1)
    local = np.array([cells @ zz + pressure, cells @ (rr + around) + 2 * pressure, size])
    total = comm.allreduce(local) / comm.allreduce(float(cells.sum()))
    return total[:2], float(total[2])


@pytest.mark.slow
@pytest.mark.serial  # long; ranks are compared on a slab in V12
@pytest.mark.parametrize("law", ["thermo-elasto-viscoplastic", "thermo-elasto-plastic"])
def test_a_cylinder_out_of_its_mould_is_in_balance_with_itself(comm, law):
    cutbacks = 0
    for state in simulation(comm, cylinder(TIGHT, law=law)):
        cutbacks += state.counters.cutbacks
    totals = state.totals
    assert totals["casting.solid_fraction"] == pytest.approx(1.0)
    assert totals["casting/mould.closed_fraction"] == 0.0
    means, size = stress_means(comm, state)
    assert size > 1e6, "the casting has a residual stress"
    assert comm.allreduce(state.cellwise("casting", "plastic_strain").max(initial=0.0), max) > 1e-3
    assert np.abs(means).max() < 1e-6 * size
    assert totals["energy_error"] < 1e-6
    assert totals["casting.dissipation"] > 0
    assert cutbacks == 0
