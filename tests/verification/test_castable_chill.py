"""A free body of castable metal that starts solid expands by its own mean expansion.

Reference: `free_bar`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.materials.lookup import find_material
from tests.coupled_cases import merged, states
from tests.verification import free_bar
from tests.verification.free_bar import HOT, LENGTH, START, growth

pytestmark = pytest.mark.sampled


def bar(metal: str, history: list[list[float]], **changes: Any) -> dict[str, Any]:
    """Return the bar by displacements, in steps of a second."""
    case = merged(free_bar.bar(metal, history, **changes), {"time": {"fixed_step": 1.0}})
    case["bodies"][0]["formulation"] = "displacement"
    return case


def ends(comm, data: dict[str, Any]) -> list[float]:
    return free_bar.ends(states(comm, data))


@pytest.mark.parametrize("metal", ["Cu-pure", "GJL-250", "CuSn12", "AlSi7Mg", "steel-H13"])
@pytest.mark.parametrize("stress_free", [None, 20.0, 200.0])
def test_a_chill_expands(metal, stress_free, comm):
    changes = {} if stress_free is None else {"stress_free": stress_free}
    hot = 400.0 if metal == "AlSi7Mg" else HOT
    found = ends(comm, bar(metal, [[0, START], [1, START], [2, hot]], **changes))
    free = START if stress_free is None else stress_free
    expected = [LENGTH * growth(metal, free, T) for T in (START, hot)]
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
