"""A frame of thin bars and a thick one that cools last, and the stress that is left in it.

E = 70 GPa, α = 24e-6/K, areas 2e-4 and 4e-4 m²; the thick bar is plastic for the last time when it
is 120 K hotter, and elastic from there on. Bars of one length on which no force acts bear 67.2 and
-134.4 MPa then, σ_2 = E α ΔT_p A_1/(A_1 + A_2). The frame is cut across its bars, which have one
strain along them, and half of it is a strip: six columns of cells, of which the temperature passes
from that of the thick bar to that of the thin ones in two, with the same mean as a jump between the
areas. Reference: `castx/foundry/cracking.py`, `three_bar_stresses`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.foundry.cracking import three_bar_stresses
from tests import coupled_cases

YOUNG, EXPANSION, LAG = 70e9, 24e-6, 120.0
COLUMN, COLD = 0.01, 20.0


def frame(formulation: str, cells: str) -> dict[str, Any]:
    """Return a frame without stress while its thick bar is hotter, which cools until all is."""
    warm = [[0.0, COLD + LAG], [3 * COLUMN, COLD + LAG], [5 * COLUMN, COLD], [6 * COLUMN, COLD]]
    metal = {"density": 1000.0, "heat_capacity": 1000.0, "conductivity": 1e3,
             "young_modulus": YOUNG, "poisson_ratio": 0.0, "expansion": EXPANSION}  # fmt: skip
    cooled = {"type": "temperature", "value": COLD}
    return {
        "geometry": {"generator": "slab", "model": "generalised-plane-strain", "cells": cells,
                     "length": 6 * COLUMN, "width": COLUMN, "size": COLUMN},
        "materials": {"metal": metal},
        "bodies": [{"name": "casting", "material": "metal", "formulation": formulation,
                    "temperature": {"along": "x", "table": warm}}],
        "boundaries": [
            {"on": "casting/wall", "displacement": {"normal": 0.0}, "heat": cooled},
            {"on": "casting/bottom", "displacement": {"normal": 0.0}, "heat": cooled},
            {"on": "casting/top", "heat": cooled},
        ],
        "time": {"end": 1e4, "first_step": 1e3, "largest_step": 1e3, "fixed_step": 1e3},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-12, "heat_tolerance": 1e-12},
    }  # fmt: skip


@pytest.mark.ranks
@pytest.mark.parametrize(
    ("formulation", "cells"), [("displacement", "simplices"), ("q1p0", "quadrilaterals")]
)
def test_the_residual_stresses_of_the_frame(comm, formulation, cells):
    state = coupled_cases.final_state(comm, frame(formulation, cells))
    thick, thin = three_bar_stresses(YOUNG, EXPANSION, LAG, 2e-4, 4e-4)
    assert (thick, thin) == pytest.approx((67.2e6, -134.4e6), rel=1e-12)
    body = state.mesh.bodies["casting"]
    middle = body.points[body.nodes.dofmap.list].mean(axis=1)[:, 0]
    along = state.cellwise("casting", "stress")[:, 2]
    np.testing.assert_allclose(along[middle < 3 * COLUMN], thick, rtol=1e-6)
    np.testing.assert_allclose(along[middle > 5 * COLUMN], thin, rtol=1e-6)
