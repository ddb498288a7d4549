"""Two heavy ends and a thin neck that freezes first: what it cuts off ends with pores of s of it.

A section of two squares of 40 mm, which a neck of 8 mm joins, is held by its walls, so that melt
and pores alone make up for what freezing lacks. The top of one end feeds it. The neck closes while
both ends are liquid, and no melt passes it from then on: of the V of melt beyond it pores of
s V = V β/(1 + β) are left, which is the deficit of the hot spot. A little before it closes the neck
chokes, and what freezes beyond it until then has pores too. Neck and fed end are sound, with less
than 0.1 %.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from castx.arrays import BoolArray, FloatArray
from castx.case.reading.read import read_case
from castx.domain.measures import nodal_volumes
from castx.foundry.pools.hot_spots import HotSpots
from castx.foundry.pools.pooled_metal import pooled_metals
from tests.coupled_cases import merged, simulation
from tests.verification.sections import Corner, write_section
from tests.verification.test_mush_flow import MUSH
from tests.verification.test_rest_and_sealed_boxes import ALLOY, GRAVITY

pytestmark = [pytest.mark.serial, pytest.mark.slow]

GRID, END, NECK, HALF = 2e-3, 20, 12, 2
"""Size of the cells [m], side of the ends, length and half of the height of the neck in them."""
FIRST, SECOND = END, END + NECK
"""Ends of the neck."""
SOUND = 1e-3
"""Share of pores below which metal is sound."""


def surface(a: Corner, b: Corner) -> str:
    """Return the name of the surface of an edge."""
    return "top" if a[1] == b[1] == END and a[0] < FIRST else "wall"


def dumbbell(mesh: Path, spacing: float, shrinkage: float) -> dict[str, Any]:
    """Return the case, of dendrites of a spacing [m] and a shrinkage s."""
    boxes = [
        (0, FIRST, 0, END),
        (FIRST, SECOND, END // 2 - HALF, END // 2 + HALF),
        (SECOND, SECOND + END, 0, END),
    ]
    write_section(mesh, boxes, GRID, ("top", "wall"), surface)
    numbers = {"arm_spacing": spacing, "solidification_shrinkage": shrinkage}
    return {
        "geometry": {"file": str(mesh), "model": "plane-strain"},
        "materials": {"alloy": merged(ALLOY, {**MUSH["materials"]["alloy"], **numbers})},
        "bodies": [
            {"name": "casting", "material": "alloy", "feeding": "darcy", "temperature": 640.0},
        ],
        "boundaries": [
            {"on": "casting/wall", "displacement": {"x": 0.0, "y": 0.0},
             "heat": {"type": "convection", "coefficient": 1000.0, "ambient": 50.0}},
        ],
        "loads": {"gravity": [0.0, -GRAVITY]},
        "foundry": {"feeders": ["casting/top"]},
        "time": {"end": 100.0, "first_step": 0.05, "largest_step": 0.2},
        "coupling": {"scheme": "staggered"},
        "solver": {"linear": "direct"},
    }  # fmt: skip


class Frozen(NamedTuple):
    """The dumbbell when all of it is solid, by its cells.

    Attributes:
        void: pores, per metre [m²].
        shares: of pores in the cells.
        cut_off: whether one of their nodes held melt beyond the neck when it closed.
        beyond: whether they lie beyond the middle of the neck.
        deficit: of the hot spot [m²].
        lacking: s times the melt beyond the neck when it closed [m²].
    """

    void: FloatArray
    shares: FloatArray
    cut_off: BoolArray
    beyond: BoolArray
    deficit: float
    lacking: float


def frozen(comm, data: dict[str, Any]) -> Frozen:
    """Return the dumbbell as it ends."""
    run = simulation(comm, data)
    spots = HotSpots(run.mesh, pooled_metals(read_case(data, Path("case.toml"))))
    body = run.mesh.bodies["casting"]
    corners, x, middle = body.nodes.dofmap.list, body.points[:, 0] / GRID, FIRST + NECK / 2
    volumes = nodal_volumes(body, "plane-strain")
    left: FloatArray | None = None
    for state in run:
        spots.update(state)
        liquid = 1.0 - state.nodal("casting", "solid_fraction")
        if left is None and liquid[np.isclose(x, middle)].max() <= 0.0:
            left = np.where(x > middle, liquid, 0.0)
        if liquid.max() <= 0.0:
            break
    assert left is not None
    assert liquid.max() <= 0.0
    shares = state.cellwise("casting", "pores")
    run.destroy()
    areas = 0.5 * np.abs(np.linalg.det(np.diff(body.points[corners][:, :, :2], axis=1)))
    lacking = data["materials"]["alloy"]["solidification_shrinkage"] * volumes @ left
    return Frozen(
        areas * shares, shares, (left > 0.0)[corners].any(axis=1), x[corners].mean(axis=1) > middle,
        spots.ranked[0].deficit or 0.0, float(lacking),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("spacing", "shrinkage", "choked"), [(200e-6, 0.05, 0.07), (2e-3, 0.065, 0.025)]
)
def test_pores_are_s_of_the_melt_that_is_cut_off(comm, tmp_path, spacing, shrinkage, choked):
    """More of them by 6 % where arms are fine, by 2 % where they are coarse."""
    found = frozen(comm, dumbbell(tmp_path / "dumbbell.msh", spacing, shrinkage))
    cut_off = found.void[found.beyond].sum()
    assert found.shares[~found.cut_off].max() < SOUND
    assert found.deficit == pytest.approx(found.lacking, rel=1e-6)
    assert 1.0 < cut_off / found.lacking < 1.0 + choked
    assert found.void[~found.beyond].sum() < 5e-3 * cut_off
