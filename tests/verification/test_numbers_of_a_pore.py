"""One pore in several numbers: where they agree, and what each leaves out.

A sealed rigid box that freezes from its walls has one cavity of s V. The deficit of its hot spot,
`unfed_volume` of history.csv and the sum of the field `pores` over the volume agree in it. Where
the solid contracts, the two of the mechanics agree, and the deficit knows nothing of it.
"""

from __future__ import annotations

from pathlib import Path

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


def numbers(comm, *changes, feeding: str) -> tuple[float, float, float, float]:
    """Return deficit, `unfed_volume`, the sum of `pores`, all per metre, and its largest value."""
    data = chilled(AS_IT_IS, MUSH, *changes)
    data["bodies"][0] |= {"feeding": feeding}
    run = simulation(comm, data)
    spots = HotSpots(run.mesh, pooled_metals(read_case(data, Path("case.toml"))))
    for state in run:
        spots.update(state)
        pores = state.cellwise("casting", "pores")
        unfed = state.totals["casting.unfed_volume"]
    summed = float(areas(state) @ pores)
    run.destroy()
    return float(spots.ranked[0].deficit or 0.0), unfed, summed, float(pores.max())


@pytest.mark.parametrize("feeding", ["pockets", "darcy"])
def test_in_rigid_walls_all_numbers_of_a_cavity_agree(comm, feeding):
    deficit, unfed, summed, largest = numbers(comm, feeding=feeding)
    assert deficit == pytest.approx(CAVITY, rel=1e-9)
    assert unfed == pytest.approx(CAVITY, rel=1e-6)
    assert summed == pytest.approx(unfed, rel=1e-9)
    assert largest > 2 * SHRINKAGE  # it lies where the metal froze last, or at the top


@pytest.mark.parametrize("feeding", ["pockets", "darcy"])
def test_the_deficit_leaves_out_what_held_walls_add(comm, feeding):
    """Solid that sticks to rigid walls contracts at the cost of the cavity."""
    shrinking = {"materials": {"alloy": {"expansion": 25e-6}}}
    deficit, unfed, summed, _ = numbers(comm, shrinking, feeding=feeding)
    assert deficit == pytest.approx(CAVITY, rel=1e-9)
    assert summed == pytest.approx(unfed, rel=1e-9)
    assert 1.02 * CAVITY < unfed < 1.1 * CAVITY
