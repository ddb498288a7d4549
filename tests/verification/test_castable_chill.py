"""A free body of castable metal that starts solid expands by its own mean expansion.

A bar of length L that is free and heated from T_0 grows by

    u = L [α(T)(T − T_ref) − α(T_sf)(T_sf − T_ref)],

T_sf being `stress_free` if the case gives one, else T_0, and α and T_ref those of the database.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.materials.lookup import find_material
from tests.coupled_cases import nodal, states

pytestmark = pytest.mark.sampled

LENGTH, START, HOT = 0.02, 100.0, 500.0


def bar(metal: str, history: list[list[float]], **changes: Any) -> dict[str, Any]:
    """Return a bar on rollers whose temperature follows a table."""
    return {
        "geometry": {
            "generator": "slab", "model": "plane-stress",
            "length": LENGTH, "width": 0.01, "size": 0.005,
        },
        "materials": {"metal": {"extends": metal, **changes}},
        "bodies": [
            {"name": "casting", "material": "metal", "temperature_history": history,
             "formulation": "displacement"},
        ],
        "boundaries": [
            {"on": f"casting/{side}", "displacement": {"normal": 0.0}}
            for side in ("wall", "bottom")
        ],
        "coupling": {"scheme": "mechanical"},
        "time": {"end": history[-1][0], "fixed_step": 1.0},
    }  # fmt: skip


def ends(comm, data: dict[str, Any]) -> list[float]:
    """Return the displacement of the far end after each step [m]."""
    found = []
    for state in states(comm, data):
        move = nodal(state, "casting", "displacement")[:, 0]
        found.append(float(move[np.argmax(np.abs(move))]))
    return found


@pytest.mark.parametrize("metal", ["Cu-pure", "GJL-250", "CuSn12", "AlSi7Mg", "steel-H13"])
@pytest.mark.parametrize("stress_free", [None, 20.0, 200.0])
def test_a_chill_expands(metal, stress_free, comm):
    changes = {} if stress_free is None else {"stress_free": stress_free}
    hot = 400.0 if metal == "AlSi7Mg" else HOT
    found = ends(comm, bar(metal, [[0, START], [1, START], [2, hot]], **changes))
    table = find_material(metal)
    reference = table.expansion_reference or 0.0

    def length(temperature: float) -> float:
        return float(table.expansion(temperature)) * (temperature - reference)

    free = START if stress_free is None else stress_free
    expected = [LENGTH * (length(T) - length(free)) for T in (START, hot)]
    np.testing.assert_allclose(found[1:], expected, rtol=1e-8, atol=1e-14)
    assert expected[1] > 0.0
    if stress_free is None:
        assert abs(found[1]) < 1e-12, "no strain before it is heated"


def test_what_freezes_contracts_from_its_solidus(comm):
    """The same metal as a casting: no strain above the solidus, then α(T)(T − T_ref)."""
    changes = {"liquid": "none", "solidification_shrinkage": 0.0}
    data = bar("Al-pure", [[0, 680], [1, 670], [2, 400]], **changes)
    warm, cold = ends(comm, data)[1:]
    table = find_material("Al-pure")
    reference, solidus = table.expansion_reference, table.solidus
    expected = table.expansion(400.0) * (400.0 - reference)
    expected -= table.expansion(solidus) * (solidus - reference)
    assert warm == 0.0
    assert cold == pytest.approx(LENGTH * float(expected), rel=1e-8)
