"""Castings whose last liquid is cut off: balance of feeding, and what their pores depend on."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from castx.materials.lookup import find_material
from tests.coupled_cases import fields, largest_difference, nodal, ordered, places, states
from tests.verification.trapped_box import box

pytestmark = pytest.mark.sampled

def history(comm, data) -> dict[str, np.ndarray]:
    """Return the totals of the casting in all accepted steps, and the fields of the last one."""
    found: dict[str, list[float]] = {}
    for state in states(comm, data):
        for name, value in state.totals.items():
            if name.startswith("casting."):
                found.setdefault(name.removeprefix("casting."), []).append(value)
        last = fields(state)
        cutbacks = state.counters.cutbacks
    assert cutbacks == 0
    return {name: np.array(values) for name, values in found.items()} | last


@pytest.mark.ranks
@pytest.mark.parametrize("contact", ["none", "condensed", "by faces"])
def test_a_body_that_nothing_touches_is_fed(comm, contact) -> None:
    """Heat closes no surface, contact does, however its nodes are paired."""
    keys = {"method": "condensed", "pairing": "node-to-face", "surfaces": ["mould", "casting"]}
    if contact != "by faces":
        keys = {"method": contact}
    data = box({"time": {"end": 1.0}})
    data["interfaces"][0]["contact"] = keys
    last = history(comm, data)
    demand = last["feeding_demand"][-1]
    assert demand > 0.0
    assert last["fed_volume"][-1] == pytest.approx(demand if contact == "none" else 0.0, rel=1e-12)


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_a_lidded_box_ends_with_pores(comm, cells) -> None:
    """Nothing is fed; the void, never negative, is the demand but for what the walls give way."""
    found = history(comm, box(cells=cells))
    demand, void = found["feeding_demand"], found["unfed_volume"]
    volume = 0.04 * 0.03
    assert (void >= 0).all() and not found["fed_volume"].any()
    assert (np.diff(demand) >= 0).all()
    alloy = find_material("AlSi7Mg", {})
    assert alloy.liquid is not None
    expected = alloy.description.solidification_shrinkage * alloy.liquid.coherency * volume
    frozen = found["solid_fraction"][-1]
    assert 0.5 < frozen and 0.4 * expected < demand[-1] <= expected * (1 + 1e-9)
    # The cavity itself grows by less than a hundredth as the mould warms, and metal follows it.
    assert 0.25 * demand[-1] < void[-1] < demand[-1] + 0.01 * volume
    assert found["pocket_pressure"].max() < 1e3  # without `cavitation` pockets do not pull


def test_an_open_box_is_fed(comm) -> None:
    """As long as its top is liquid: the balance is demand = fed."""
    found = history(comm, box({"time": {"end": 4.0}}, lid=False))
    assert found["feeding_demand"][-1] > 1e-6
    np.testing.assert_allclose(found["fed_volume"], found["feeding_demand"], rtol=1e-12)
    assert not found["unfed_volume"].any()


def test_the_cavity_pressure_decides_how_a_pocket_pulls(comm) -> None:
    """Before pores open at 100 kPa the walls follow, and so less void is left."""
    short = {"time": {"end": 6.0}}
    without = history(comm, box(short))
    depressed = history(comm, box(short, {"materials": {"alloy": {"cavitation": 1e5}}}))
    assert (
        largest_difference(
            {"casting displacement": without["casting displacement"]},
            {"casting displacement": depressed["casting displacement"]},
        )[0]
        > 1e-3
    )
    assert depressed["unfed_volume"][-1] < without["unfed_volume"][-1]
    assert without["pocket_pressure"][-1] < 0.0 < depressed["pocket_pressure"].max() <= 1e5


def slips_at_corners(state) -> np.ndarray:
    """Return how far the casting has moved from its mould at its four corners [m]."""
    place, moved = {}, {}
    for name in ("casting", "mould"):
        points = places(state, name)
        place[name] = ordered(state.mesh.comm, points, points)
        moved[name] = nodal(state, name, "displacement")
    low, high = place["casting"].min(axis=0), place["casting"].max(axis=0)
    corners = np.array([[x, y] for x in (low[0], high[0]) for y in (low[1], high[1])])
    at = {name: cKDTree(place[name]).query(corners)[1] for name in place}
    return np.linalg.norm(moved["casting"][at["casting"]] - moved["mould"][at["mould"]], axis=1)


@pytest.mark.parametrize("normals, slides", [("automatic", False), ("averaged", True)])
def test_melt_slides_through_the_corners_of_its_mould(comm, normals, slides) -> None:
    """Unless both walls hold it, each along a normal of its own."""
    data = box({"time": {"end": 2.0}})
    data["interfaces"][0]["contact"] = {"normals": normals}
    found = np.array([slips_at_corners(state) for state in states(comm, data)])
    assert len(found) > 2
    if slides:
        assert found[-1].max() > 1e-7
    else:
        assert found.max() < 1e-15
