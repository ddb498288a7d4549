"""V5: steady heat through two plates with a given resistance between them.

Reference: `castx/proof/verification/heat/plates.py`.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.heat.body import HeatBody
from castx.proof.verification.heat.plates import Plates
from castx.tables import Table
from tests.heat_conditions import surface_heat
from tests.heat_resistance import of_resistance
from tests.verification.heat_strips import casting_on_mould, material, profile, strip

PLATES = Plates()
THICKNESS, CONDUCTIVITY, EXCHANGE = PLATES.thickness, PLATES.conductivity, PLATES.exchange
COLD, HOT, FLUX = PLATES.cold, PLATES.hot, PLATES.flux


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
@pytest.mark.parametrize("model", ["generalised-plane-strain", "3d"])
def test_flux_and_wall_temperatures(comm, model, cells):
    size = THICKNESS / 9
    mesh = strip(
        comm, size=size, length=THICKNESS, mould_length=THICKNESS, cells=cells, model=model
    )
    area = size**2 if model == "3d" else size
    steel = material(heat_capacity=4e6, conductivity=CONDUCTIVITY)
    given = {"casting": HOT, "mould": COLD}
    heat = casting_on_mould(
        mesh,
        [HeatBody(name, steel, 20.0) for name in given],
        "law",
        [
            surface_heat(f"{name}/far", "temperature", value=Table.constant(value))
            for name, value in given.items()
        ],
    )
    owned = mesh.bodies["casting"].nodes.dofmap.index_map.size_local
    pairs = np.count_nonzero(mesh.bodies["casting"].surface_nodes("mould") < owned)
    state = of_resistance(np.full(pairs, 1 / EXCHANGE))
    for k in range(3):
        heat.advance(k * 1e9, 1e9, [(state, state)])
        before = heat.totals()
        heat.commit()
    after = heat.totals()
    passed = {name: (after[name] - before[name]) / 1e9 / area for name in after}
    assert pytest.approx(5369.13, abs=5e-3) == FLUX
    assert passed["casting/mould.heat"] == pytest.approx(FLUX, rel=1e-6)
    assert passed["casting/far.heat"] == pytest.approx(FLUX, rel=1e-6)
    assert passed["mould/far.heat"] == pytest.approx(-FLUX, rel=1e-6)
    walls = {name: profile(mesh, heat, name) for name in given}
    assert walls["casting"][1][0] == pytest.approx(233.557, abs=5e-4)
    assert walls["mould"][1][-1] == pytest.approx(166.443, abs=5e-4)
    assert walls["casting"][1][0] == pytest.approx(HOT - FLUX * THICKNESS / CONDUCTIVITY, rel=1e-6)
