"""A hub between two feeders: pores lie where the last pool was cut off, and nowhere else.

A section 40 mm square with an arm on either side, 16 mm high, that a chill closes in its middle;
each arm leads to a feeder that stays hot. Its walls hold it: melt and pores alone make up for
what freezing lacks. Once the chills have closed the arms nothing feeds what is liquid between
them, and it ends with pores of s of its liquid then: the deficit of the hot spot. What the feeders
reach is sound. Fine dendrites choke the arms before they close, when by Darcy's law along them, in
one dimension, what the hub asks for draws its melt to the cavity pressure: what freezes from then
until they close has pores of s of what was liquid in it. Without feeders all of it ends with pores
of s V.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from castx.arrays import BoolArray, FloatArray
from castx.case.reading.read import read_case
from castx.domain.measures import nodal_volumes
from castx.foundry.pools.hot_spots import HotSpots
from castx.foundry.pools.pooled_metal import pooled_metals
from castx.foundry.porosity import KOZENY_CARMAN
from tests.coupled_cases import merged, simulation
from tests.verification.sections import Corner, write_section
from tests.verification.test_mush_flow import MUSH
from tests.verification.test_rest_and_sealed_boxes import ALLOY, GRAVITY, SHRINKAGE

pytestmark = pytest.mark.serial

GRID = 4e-3
FEEDER, ARM, HUB = 6, 6, 10
MIDDLE, HIGH = FEEDER + ARM + HUB // 2, 14
SOUND = 1e-3
"""Share of pores below which metal is sound."""
ENDS = FEEDER, FEEDER + ARM + HUB
"""First nodes of the arms along x."""
CAVITY, VISCOSITY = 101e3, 1e-3
"""Pressure [Pa] at which pores open by default, and viscosity of the melt [Pa s]."""
POINTS = 16
"""Points in a cell along each direction."""


def surface(a: Corner, b: Corner) -> str:
    """Return the name of the surface of an edge: of hub, chill, feeder, or rest."""
    if a[1] == b[1] == HIGH:
        return "left" if a[0] < MIDDLE else "right"
    away = abs(0.5 * (a[0] + b[0]) - MIDDLE) - HUB // 2
    if away <= 0:
        return "hub"
    return "chill" if a[1] == b[1] and 2 < away < 4 else "rest"


def section(path: Path, fed: bool) -> None:
    """Write the mesh, without its feeders or with them."""
    ends = FEEDER, FEEDER + ARM, FEEDER + ARM + HUB, FEEDER + 2 * ARM + HUB
    boxes = [(ends[0], ends[3], 3, 7), (ends[1], ends[2], 0, 10)]
    if fed:
        boxes += [(0, ends[0], 0, HIGH), (ends[3], ends[3] + FEEDER, 0, HIGH)]
    names = ("hub", "chill", "rest", "left", "right")
    write_section(path, boxes, GRID, names if fed else names[:3], surface)


def hub(mesh: Path, fed: bool) -> dict[str, Any]:
    """Return the case, of arms of 0.2 mm."""
    held = {"displacement": {"x": 0.0, "y": 0.0}}
    cooled = {
        name: {"heat": {"type": "convection", "coefficient": h, "ambient": 50.0}}
        for name, h in {"hub": 3000.0, "chill": 1e4}.items()
    }
    metal = merged(ALLOY, {**MUSH["materials"]["alloy"], "arm_spacing": 200e-6})
    return {
        "geometry": {"file": str(mesh), "model": "plane-strain"},
        "materials": {"alloy": metal},
        "bodies": [
            {"name": "casting", "material": "alloy", "feeding": "darcy", "temperature": 640.0},
        ],
        "boundaries": [
            {"on": f"casting/{name}", **held, **cooled.get(name, {})}
            for name in ("hub", "chill", "rest")
        ],
        "loads": {"gravity": [0.0, -GRAVITY]},
        "foundry": {"feeders": ["casting/left", "casting/right"] if fed else []},
        "time": {"end": 60.0, "first_step": 0.05, "largest_step": 0.2},
        "coupling": {"scheme": "staggered"},
        "solver": {"linear": "direct"},
    }


def between(points: FloatArray) -> BoolArray:
    """Return whether points lie between the feeders."""
    return np.asarray(np.abs(points[:, 0] / GRID - MIDDLE) < HUB / 2 + ARM - 0.5)


class Ending(NamedTuple):
    """The hub when all between its feeders is solid, by its cells, and when it was cut off.

    Attributes:
        volumes: per metre [m²].
        pores: their shares.
        centres: [m].
        cut_off: whether one of their nodes held melt that was cut off.
        last: where the metal froze last [m].
        deficit: of the hot spot [m²].
        opened: volume of pores that have opened since it was cut off [m²].
        totals: of the casting.
    """

    volumes: FloatArray
    pores: FloatArray
    centres: FloatArray
    cut_off: BoolArray
    last: FloatArray
    deficit: float
    opened: float
    totals: Mapping[str, float]


def frozen(comm, data) -> Ending:
    """Return the hub as it ends."""
    run = simulation(comm, data)
    spots = HotSpots(run.mesh, pooled_metals(read_case(data, Path("case.toml"))))
    body = run.mesh.bodies["casting"]
    corners, inside = body.nodes.dofmap.list, between(body.points)
    x = body.points[corners]
    (a, b), (c, d) = np.moveaxis(x[:, 1:] - x[:, :1], 0, -1)
    volumes, cut_off, first = 0.5 * np.abs(a * d - b * c), np.zeros(len(corners), dtype=bool), 0.0
    for state in run:
        spots.update(state)
        solid = state.nodal("casting", "solid_fraction")
        if not cut_off.any() and spots.ranked:
            cut_off = ((solid < 1.0) & inside)[corners].any(axis=1)
            first = state.totals["casting.unfed_volume"]
        if solid[inside].min() >= 1.0:
            break
    totals, spot = dict(state.totals), spots.ranked[0]
    pores = state.cellwise("casting", "pores")
    run.destroy()
    return Ending(
        volumes, pores, x.mean(axis=1), cut_off, np.array(spot.pool.place), spot.deficit or 0.0,
        totals["casting.unfed_volume"] - first, totals,
    )  # fmt: skip


def test_pores_lie_where_the_last_pool_was_cut_off(comm, tmp_path):
    section(tmp_path / "hub.msh", fed=True)
    found = frozen(comm, hub(tmp_path / "hub.msh", fed=True))
    void = found.volumes * found.pores
    assert found.pores[~found.cut_off].max() < SOUND
    assert void[~found.cut_off].sum() < 1e-3 * void.sum()
    assert found.opened == pytest.approx(found.deficit, rel=0.01)
    assert found.totals["casting.fed_volume"] > void.sum() > found.opened
    place = found.centres[found.pores.argmax()]
    np.testing.assert_allclose(found.last, [MIDDLE * GRID, 5 * GRID])
    assert abs(place[0] - found.last[0]) < GRID  # above, since melt sinks
    assert 0.0 < place[1] - found.last[1] < 3 * GRID


class Choked(NamedTuple):
    """What arms that choke before they close leave in metal that is solid as they do.

    Attributes:
        first: when the first pore opens [s].
        choked: when the suction along the arms reaches the cavity pressure [s].
        pores: of cells that are solid when the arms close, per metre [m²].
        expected: s of what was liquid in these cells as the arms choked, likewise.
    """

    first: float
    choked: float
    pores: float
    expected: float


def resistance(points: FloatArray, liquid: FloatArray, arm: int) -> float:
    """Return ∫ dx/∫ K dy along an arm, over 1/λ2² [-].

    Args:
        points: of the nodes [m].
        liquid: liquid fraction there.
        arm: number of its first nodes along x.
    """
    corners = np.round(points[:, :2] / GRID).astype(int)
    by_place = np.full(corners.max(axis=0) + 1, np.nan)
    by_place[tuple(corners.T)] = liquid
    inner = (np.arange(POINTS) + 0.5) / POINTS
    x, y = (first + np.arange(0, n, 1.0)[:, None] + inner for first, n in ((arm, ARM), (3, 4)))
    at = np.meshgrid(x.ravel(), y.ravel(), indexing="ij")
    g = np.maximum(map_coordinates(by_place, at, order=1), 0.02)
    through = (g**3 / (KOZENY_CARMAN * np.maximum(1.0 - g, 0.05) ** 2)).sum(axis=1)
    return float(np.sum(1.0 / through))


def choked(comm, mesh: Path, spacing: float) -> Choked:
    """Return what the arms choke off, by dendrites of this spacing [m]."""
    data = merged(hub(mesh, fed=True), {"materials": {"alloy": {"arm_spacing": spacing}}})
    run = simulation(comm, data)
    body = run.mesh.bodies["casting"]
    points, corners = body.points, body.nodes.dofmap.list
    volumes = nodal_volumes(body, "plane-strain")
    asking = np.abs(points[:, 0] / GRID - MIDDLE) <= (HUB + ARM) / 2
    middle = np.isclose(points[:, 0], (FEEDER + ARM / 2) * GRID)
    times, fractions, void, suctions = [], [], [], []
    for state in run:
        times.append(state.time)
        fractions.append(state.nodal("casting", "solid_fraction").copy())
        void.append(state.totals["casting.unfed_volume"])
        if len(times) > 1:
            before, after = fractions[-2:]
            arms = [resistance(points, 1.0 - 0.5 * (before + after), first) for first in ENDS]
            rate = volumes[asking] @ (after - before)[asking] / (times[-1] - times[-2])
            drag = VISCOSITY / spacing**2 / sum(1.0 / one for one in arms)
            suctions.append(SHRINKAGE / (1.0 - SHRINKAGE) * rate * drag)
        if fractions[-1][middle].min() >= 1.0:
            break
    solid = (fractions[-1] >= 1.0)[corners].all(axis=1)
    pores = state.cellwise("casting", "pores")
    run.destroy()
    middles = 0.5 * (np.array(times[1:]) + times[:-1])
    moment = float(np.interp(np.log(CAVITY), np.log(suctions), middles))
    left = 1.0 - np.array([np.interp(moment, times, own) for own in np.transpose(fractions)])
    areas = 0.5 * np.abs(np.linalg.det(np.diff(points[corners][:, :, :2], axis=1)))
    return Choked(
        times[int(np.argmax(np.array(void) > 0.0))], moment, float(areas[solid] @ pores[solid]),
        float(SHRINKAGE * areas[solid] @ left[corners[solid]].mean(axis=1)),
    )  # fmt: skip


@pytest.mark.slow
def test_what_freezes_behind_choked_arms_has_pores(comm, tmp_path):
    """Dendrites of 50 and of 100 µm: their permeabilities are as 1 to 4."""
    section(tmp_path / "hub.msh", fed=True)
    fine, coarse = (choked(comm, tmp_path / "hub.msh", spacing) for spacing in (50e-6, 100e-6))
    for found in (fine, coarse):
        assert abs(found.first - found.choked) < 0.3  # steps of 0.2 s
        assert 1 / 1.6 < found.pores / found.expected < 1.6
    assert fine.first < coarse.first - 0.1
    assert fine.pores > 1.5 * coarse.pores


def test_without_feeders_all_lacks(comm, tmp_path):
    section(tmp_path / "hub.msh", fed=False)
    found = frozen(comm, hub(tmp_path / "hub.msh", fed=False))
    volume = found.volumes.sum()
    for lacking in (found.deficit, found.totals["casting.unfed_volume"]):
        assert lacking == pytest.approx(SHRINKAGE * volume, rel=1e-6)
    assert found.volumes @ found.pores == pytest.approx(SHRINKAGE * volume, rel=1e-6)
    assert found.totals["casting.fed_volume"] == 0.0
    assert found.centres[found.pores.argmax()][1] > 9 * GRID
