"""A mould with a lid, full of liquid that freezes: nothing feeds it, and it rests on the floor.

Reference: the weight and complementarity after every step; the demand of the solid fractions of all
cells, and a void that it explains.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.lookup import find_material
from castx.process.state import State
from tests.defaults.runs import bears, by_default, complies
from tests.verification.trapped_box import box

WIDTH, HEIGHT = 0.04, 0.03
ALLOY = find_material("AlSi7Mg")
WEIGHT = ALLOY.density * 9.81 * WIDTH * HEIGHT


def demand(state: State) -> float:
    """Return s Σ V min(f_s, f_c) of the cells of the casting [m³ for a metre of depth]."""
    assert state.problem.mechanics is not None and ALLOY.liquid is not None
    body = state.problem.mechanics.bodies["casting"]
    owned = body.owned_cells
    volumes = body.points.weights.sum(axis=1)[:owned]
    fraction = np.minimum(state.nodal("casting", "solid_fraction"), ALLOY.liquid.coherency)
    shrunk = float(volumes @ fraction[body.cell_nodes[:owned]].mean(axis=1))
    return ALLOY.description.solidification_shrinkage * state.mesh.comm.allreduce(shrunk)


def test_nothing_feeds_a_closed_box_and_its_floor_bears_it(comm):
    for state in by_default(comm, box()):
        bears(state, "casting/mould", WEIGHT)
        complies(state, WEIGHT)
        totals = {name.removeprefix("casting."): value for name, value in state.totals.items()}
        assert totals["feeding_demand"] == pytest.approx(demand(state), rel=1e-9, abs=1e-15)
        assert totals["fed_volume"] == 0.0
        # The cavity itself grows by less than a hundredth as the mould warms, and metal follows it.
        assert 0.0 <= totals["unfed_volume"] <= demand(state) + 0.01 * WIDTH * HEIGHT
    assert totals["solid_fraction"] > 0.9
    assert totals["unfed_volume"] > 0.25 * demand(state) > 0.0
