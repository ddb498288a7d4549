"""One pore in several numbers: where they agree, and what each leaves out.

A sealed rigid box that freezes from its walls has one cavity of s V. The deficit of its hot spot,
`unfed_volume` of history.csv and the sum of the field `pores` over the volume agree in it. Where
the solid contracts, the two of the mechanics agree, and the deficit knows nothing of it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.case.reading.read import read_case
from castx.foundry.pools.hot_spots import HotSpots
from castx.foundry.pools.pooled_metal import pooled_metals
from tests.coupled_cases import simulation
from tests.verification.test_mush_flow import MUSH
from tests.verification.test_rest_and_sealed_boxes import SHRINKAGE, VOLUME, chilled

CAVITY = SHRINKAGE * VOLUME["plane-strain"]
AS_IT_IS = {"materials": {"alloy": {"cavitation": 10.0}}}


def areas(state) -> FloatArray:
    """Return the areas of the triangles of the casting."""
    body = state.mesh.bodies["casting"]
    a, b, c = np.moveaxis(body.points[body.nodes.dofmap.list], 1, 0)
    (x, y), (v, w) = (b - a).T, (c - a).T
    return np.asarray(0.5 * np.abs(x * w - y * v))


def contracted(state, alloy: dict[str, Any]) -> float:
    """Return what the casting has contracted since it froze, less what stress has stretched.

    Both are volumes per metre, from temperatures and mean stresses at the end.
    """
    body, metal = state.mesh.bodies["casting"], state.problem.mechanics.bodies["casting"].material
    cooled = alloy["solidus"] - state.nodal("casting", "temperature")[body.nodes.dofmap.list].mean(
        axis=1
    )
    stretched = metal.start_volume.mean_stress * metal.conditions.solid_compressibility
    return float(areas(state) @ (3 * alloy.get("expansion", 0.0) * cooled - stretched))


def numbers(comm, *changes, feeding: str) -> tuple[float, float, float, float, float]:
    """Return deficit, `unfed_volume`, sum of `pores`, its largest value, and the contraction.

    Volumes are per metre.
    """
    data = chilled(AS_IT_IS, MUSH, *changes)
    data["bodies"][0] |= {"feeding": feeding}
    run = simulation(comm, data)
    spots = HotSpots(run.mesh, pooled_metals(read_case(data, Path("case.toml"))))
    for state in run:
        spots.update(state)
        pores = state.cellwise("casting", "pores")
        unfed = state.totals["casting.unfed_volume"]
    summed = float(areas(state) @ pores)
    less = contracted(state, data["materials"]["alloy"])
    run.destroy()
    deficit = float(spots.ranked[0].deficit or 0.0)
    return deficit, unfed, summed, float(pores.max()), less


@pytest.mark.parametrize("feeding", ["pockets", "darcy"])
def test_in_rigid_walls_all_numbers_of_a_cavity_agree(comm, feeding):
    deficit, unfed, summed, largest, _ = numbers(comm, feeding=feeding)
    assert deficit == pytest.approx(CAVITY, rel=1e-9)
    assert unfed == pytest.approx(CAVITY, rel=1e-6)
    assert summed == pytest.approx(unfed, rel=1e-9)
    assert largest > 2 * SHRINKAGE  # it lies where the metal froze last, or at the top


@pytest.mark.parametrize("feeding", ["pockets", "darcy"])
def test_the_deficit_leaves_out_what_held_walls_add(comm, feeding):
    """Solid that sticks to rigid walls contracts at the cost of the cavity, but for its stress."""
    shrinking = {"materials": {"alloy": {"expansion": 25e-6}}}
    deficit, unfed, summed, _, less = numbers(comm, shrinking, feeding=feeding)
    assert deficit == pytest.approx(CAVITY, rel=1e-9)
    assert summed == pytest.approx(unfed, rel=1e-9)
    assert unfed == pytest.approx(CAVITY + less, rel=0.01)
    assert unfed > 1.005 * CAVITY
