"""A casting freezes in its mould, comes off the walls and is molten again.

Reference: hydrostatics. What has melted rests in its mould as any liquid does: no gap, hardly any
shear, and at the walls the pressure ρ g h of the depth, whatever it has borne as a solid.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.flow import VISCOPLASTIC
from castx.materials.lookup import find_material
from castx.process.state import State
from tests.defaults.runs import bears, by_default
from tests.elastic_bodies import everywhere

WIDTH, HEIGHT, GRAVITY = 0.04, 0.03, 9.81
DENSITY = find_material("AlSi7Mg").density
HOT, COLD = 690.0, 350.0
END = 250.0
INTERFACE = "casting/mould"


def remelted() -> dict:
    """Return a casting in a thin mould whose outside is cooled and heated again."""
    table = [[0, HOT], [5, COLD], [60, COLD], [70, HOT], [END, HOT]]
    return {
        "geometry": {"generator": "box_in_mould", "model": "plane-strain",
                     "box": [WIDTH, HEIGHT], "wall": 0.01, "size": 0.01},
        "bodies": [
            {"name": "casting", "material": "AlSi7Mg", "temperature": HOT, "law": VISCOPLASTIC},
            {"name": "mould", "material": "steel-carbon", "temperature": HOT},
        ],
        "interfaces": [
            {"bodies": ["casting", "mould"],
             "heat": {"law": "limited", "closed": 5000, "gas_conductivity": 0.05}},
        ],
        "boundaries": [
            {"on": "mould/base", "displacement": {"normal": 0},
             "heat": {"type": "temperature", "value": table}},
            {"on": "mould/outside", "heat": {"type": "temperature", "value": table}},
        ],
        "loads": {"gravity": [0, -GRAVITY, 0]},
        "time": {"end": END},
    }  # fmt: skip


def largest_stress(comm, state: State) -> float:
    """Return the largest equivalent stress in the casting [Pa]."""
    return float(everywhere(comm, state.cellwise("casting", "von_mises")).max())


@pytest.mark.slow
def test_what_melts_again_rests_as_a_liquid(comm):
    frozen, opened, borne = 0.0, 0.0, 0.0
    for state in by_default(comm, remelted()):
        bears(state, INTERFACE, DENSITY * GRAVITY * WIDTH * HEIGHT)
        assert state.counters.frozen_pairs == 0
        frozen = max(frozen, state.totals["casting.solid_fraction"])
        opened = max(opened, state.totals[f"{INTERFACE}.max_gap"])
        borne = max(borne, largest_stress(comm, state))
    assert frozen > 1 - 1e-9 and opened > 1e-5 and borne > 1e6
    assert state.totals["casting.solid_fraction"] == 0.0
    np.testing.assert_allclose(everywhere(comm, state.paired(INTERFACE, "gap")), 0.0, atol=1e-12)
    depth = HEIGHT - everywhere(comm, state.pairs[INTERFACE].points)[:, 1]
    pressure = everywhere(comm, state.paired(INTERFACE, "contact_pressure"))
    column = DENSITY * GRAVITY * HEIGHT
    assert np.all(pressure >= DENSITY * GRAVITY * depth - 1e-9 * column)
    # What the walls still move shears it a little, by its viscosity.
    np.testing.assert_allclose(pressure, DENSITY * GRAVITY * depth, atol=0.2 * column)
    assert largest_stress(comm, state) < 0.2 * column
