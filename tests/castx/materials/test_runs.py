"""Every casting alloy of the database freezes onto a core with all its data in use."""

from __future__ import annotations

import pytest

from castx.materials.database import database_names
from castx.materials.flow import VISCOPLASTIC
from castx.materials.lookup import find_material
from tests.castx.materials.descriptions import table
from tests.coupled_cases import ring, simulation

pytestmark = pytest.mark.serial

ALLOYS = [name for name in database_names() if find_material(name, {}).melts]


@pytest.mark.sampled
@pytest.mark.parametrize("name", ALLOYS)
def test_a_ring_of_the_alloy_freezes_and_bears_its_stress_of_flow(comm, name) -> None:
    material = find_material(name, {})
    assert material.liquidus is not None
    data = ring({"time": {"end": 60.0, "largest_step": 10.0}}, size=0.01)
    hot = {"material": name, "temperature": material.liquidus + 20.0, "law": VISCOPLASTIC}
    data["bodies"][0] |= hot
    data["bodies"][1] |= {"material": "steel-carbon"}
    *_, state = simulation(comm, data)
    assert 0.6 < state.totals["casting.solid_fraction"] <= 1.0
    assert abs(state.totals["energy_error"]) < 1e-6
    flow, cold = material.description, state.nodal("casting", "temperature").min()
    assert flow.yield_stress is not None
    linear, saturation = (table(flow.hardening, key)(cold) for key in ("linear", "saturation"))
    hardened = 0.02 * linear + saturation
    overstress = table(flow, "viscosity")(cold) * 1e-2 ** (1.0 / table(flow, "exponent")(cold))
    stress = state.cellwise("casting", "von_mises")
    assert 2e5 < stress.max() < flow.yield_stress(cold) + hardened + overstress
