"""A casting that nothing feeds and nothing weighs: one pore opens, and steps stay long.

An alloy freezes in a steel mould under an open top that no feeder holds. Its melt has no highest
node. Steps had to go down to a millisecond, with negative pores, when all nodes began open.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.coupled_cases import cylinder, states
from tests.verification.test_mush_flow import LEDGER


@pytest.mark.slow
@pytest.mark.serial
def test_freezes_in_few_steps_and_pores_are_never_negative(comm):
    time = {"end": 15.0, "first_step": 0.05, "largest_step": 2.0, "temperature_change": 20}
    data = cylinder({"time": time}, size=0.005, radius=0.015, height=0.02)
    data["bodies"][0] |= {
        "material": "AlSi7Mg", "law": "thermo-elasto-viscoplastic", "feeding": "darcy",
    }  # fmt: skip
    data["bodies"][1]["material"] = "steel-H13"
    data["materials"], data["foundry"] = {}, {"feeders": []}
    rows = []
    for state in states(comm, data):
        rows.append([state.totals[f"casting.{name}"] for name in LEDGER])
        pores, body = state.cellwise("casting", "pores"), state.mesh.bodies["casting"]
        corners = body.points[body.nodes.dofmap.list]
    ledger = np.array(rows)
    (a, b), (c, d) = np.moveaxis(corners[:, 1:] - corners[:, :1], 0, -1)
    turns = 2 * np.pi * corners[:, :, 0].mean(axis=1) * 0.5 * np.abs(a * d - b * c)
    assert turns @ pores == pytest.approx(ledger[-1, -1], rel=1e-9)  # one pore, one number
    assert len(ledger) < 60
    demand, fed, opened, yielded, unfed = ledger.T
    assert unfed.min() >= -1e-9 * demand[-1]
    assert unfed[-1] > 0.0
    assert not fed.any()
    np.testing.assert_allclose(opened + yielded, demand, atol=1e-3 * demand[-1])
