"""Castings that nothing feeds: one pore opens, steps stay long, and a sink stays where it is.

An alloy freezes in a steel mould under an open top that no feeder holds, without weight. Its melt
has no highest node. Steps had to go down to a millisecond, with negative pores, when all nodes
began open.

In a mould with a lid the skin is drawn into its pool where it lets go of the wall. What is hot
behind the gap melts again. While such nodes were put back at the wall from any gap, pores and gap
took turns from step to step: gaps fell by 0.3 mm within one, and a run needed five times as long.
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


@pytest.mark.slow
@pytest.mark.serial
def test_a_skin_that_melts_again_is_not_drawn_back_across_its_gap(comm):
    data = {
        "geometry": {"generator": "box_in_mould", "model": "plane-strain", "lid": True,
                     "box": [0.04, 0.04], "wall": 0.03, "size": 5e-3},
        "bodies": [
            {"name": "casting", "material": "AlSi7Mg", "temperature": 670.0, "feeding": "darcy",
             "law": "thermo-elasto-viscoplastic"},
            {"name": "mould", "material": "steel-H13", "temperature": 200.0,
             "formulation": "displacement"},
        ],
        "interfaces": [
            {"bodies": ["casting", "mould"],
             "heat": {"law": "limited", "closed": 2300.0, "gas_conductivity": 0.05}},
        ],
        "boundaries": [{"on": "mould/base", "displacement": {"normal": 0.0}}],
        "loads": {"gravity": [0.0, -9.81]},
        "foundry": {"feeders": []},
        "time": {"end": 30.0, "largest_step": 2.0},
    }  # fmt: skip
    gaps, solid = [], np.zeros(0)
    molten_again = 0
    for state in states(comm, data):
        before, solid = solid, state.nodal("casting", "solid_fraction").copy()
        molten_again += int(np.count_nonzero(solid < before - 0.01)) if before.size else 0
        gaps.append(state.totals["casting/mould.max_gap"])
    falls = np.maximum.accumulate(gaps) - gaps
    assert molten_again > 0
    assert max(gaps) > 1e-4
    assert falls.max() < 1e-5
