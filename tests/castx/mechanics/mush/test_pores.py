"""Nodes at which pores open, on a slab of 20 mm by 10 mm under gravity."""

from __future__ import annotations

import numpy as np
import pytest

from castx.arrays import BoolArray
from castx.domain.mesh import BodyMesh
from castx.mechanics.mush.pores import PoreSet
from tests.castx.mechanics.lone_bodies import LENGTH, WIDTH, slab

pytestmark = pytest.mark.sampled

WEIGHT = np.array([0.0, -2e4])


def pores(comm, weight: np.ndarray = WEIGHT) -> tuple[BodyMesh, PoreSet]:
    body = slab(comm)
    return body, PoreSet(body, body.points[:, :2] @ weight, 1e3)


def begin(body: BodyMesh, found: PoreSet, **given) -> None:
    """Begin a step in melt that freezes, flows everywhere and is fed nowhere, but for `given`."""
    nodes, cells = len(body.points), len(body.nodes.dofmap.list)
    all_nodes = np.ones(nodes, dtype=bool)
    state = {
        "liquid": np.ones(nodes), "freezes": all_nodes, "melts": ~all_nodes,
        "conducts": np.ones(cells, dtype=bool), "fed": ~all_nodes,
        "empty": np.zeros(cells, dtype=bool),
    }  # fmt: skip
    found.begin(**{**state, **given})


def own(found: PoreSet, mask: BoolArray) -> BoolArray:
    return mask[: len(found.open)]


def everywhere(found: PoreSet, body: BodyMesh, mask: BoolArray) -> np.ndarray:
    """Return the places (x, y) of owned nodes of a mask on all ranks [m], in no order."""
    places = body.points[: len(found.open), :2][mask]
    return np.concatenate(body.mesh.comm.allgather(places))


def parted(body: BodyMesh) -> tuple[BoolArray, BoolArray]:
    """Return the solid nodes in the middle of the slab, and the cells through which melt flows."""
    solid = np.isclose(body.points[:, 0], LENGTH / 2)
    return solid, ~solid[body.nodes.dofmap.list].any(axis=1)


@pytest.mark.ranks
def test_one_highest_node_of_a_pool_that_nothing_reaches(comm):
    """Two pools that a solid middle parts; one of them is fed. Melt is most at one place."""
    body, found = pores(comm)
    x, y = body.points[:, 0], body.points[:, 1]
    solid, conducts = parted(body)
    top = np.isclose(y, WIDTH) & (x > 0.6 * LENGTH)
    columns = np.unique(np.concatenate(comm.allgather(x[top])).round(9))
    for place in columns[1:-1]:
        liquid = np.where(solid, 0.0, 0.5 - np.abs(x - place))
        begin(body, found, liquid=liquid, conducts=conducts, fed=np.isclose(x, 0.0))
        opened = everywhere(found, body, found.open)
        np.testing.assert_allclose(opened, [[place, WIDTH]], atol=1e-9)
        found.rewind()


@pytest.mark.ranks
def test_of_equal_nodes_the_first_of_the_mesh_file(comm):
    """Not of equal height, nor with more melt than rounding."""
    body, found = pores(comm)
    top = np.isclose(body.points[:, 1], WIDTH)
    begin(body, found, liquid=1.0 - 1e-8 * np.arange(len(top)) / len(top))
    lowest = min(comm.allgather(body.original_nodes[top].min(initial=10**9)))
    opened = np.concatenate(comm.allgather(body.original_nodes[: len(found.open)][found.open]))
    np.testing.assert_array_equal(opened, [lowest])


@pytest.mark.ranks
def test_highest_nodes_of_pools_that_nothing_reaches_rest(comm):
    """Two pools that a solid middle parts; one of them is fed."""
    body, found = pores(comm)
    x, y = body.points[:, 0], body.points[:, 1]
    solid, conducts = parted(body)
    liquid = np.where(solid, 0.0, 0.5)
    none = np.zeros(len(x), dtype=bool)
    fed = np.isclose(x, 0.0)
    begin(body, found, liquid=liquid, conducts=conducts, fed=fed, freezes=none)
    expected = np.isclose(y, WIDTH) & (x > 0.6 * LENGTH)
    np.testing.assert_array_equal(found.resting, own(found, expected))
    assert not found.open.any()


@pytest.mark.ranks
def test_melt_that_rests_keeps_its_pressure_until_it_lacks_volume(comm):
    body, found = pores(comm)
    top = own(found, np.isclose(body.points[:, 1], WIDTH))
    begin(body, found, freezes=np.zeros(len(body.points), dtype=bool))
    np.testing.assert_array_equal(found.resting, top)
    assert not found.open.any()
    volumes, none = np.ones(len(top)), np.zeros(len(top))
    for rounding in (0.0, 1e-10, -1e-10):
        assert not found.change(rounding * volumes, volumes, none)
    assert found.change(1e-6 * volumes, volumes, none) == top.any()
    np.testing.assert_array_equal(found.open, top)
    assert not found.resting.any()
    begin(body, found, freezes=np.zeros(len(body.points), dtype=bool))
    assert found.change(-1e-8 * volumes, volumes, none) == top.any()
    assert not found.resting.any()
    assert not found.open.any()


@pytest.mark.ranks
def test_without_weight_one_node_opens(comm):
    """All are highest: open, they would hold the pool at the cavity pressure throughout."""
    body, found = pores(comm, np.zeros(2))
    begin(body, found, liquid=1.0 - np.hypot(*(body.points[:, :2] - [LENGTH, 0.0]).T))
    np.testing.assert_allclose(everywhere(found, body, found.open), [[LENGTH, 0.0]], atol=1e-9)


def test_nodes_open_by_tension_and_close_by_compression(comm):
    body, found = pores(comm)
    fed = np.isclose(body.points[:, 0], 0.0)
    solid = np.isclose(body.points[:, 0], LENGTH)
    begin(body, found, fed=fed, liquid=np.where(solid, 0.0, 1.0))
    assert not found.open.any()
    ones = np.ones(len(found.open))
    assert not found.change(0.0 * ones, ones, 1e3 * ones)
    changed = found.change(0.0 * ones, ones, 1.01e3 * ones)
    expected = own(found, ~fed & ~solid)
    assert changed == found.changed == expected.any()
    np.testing.assert_array_equal(found.open, expected)
    assert not found.change(0.0 * ones, ones, 1e3 * ones)
    assert not found.changed
    found.commit()
    found.change(-1e-6 * ones, ones, 1e3 * ones)
    assert not found.open.any()
    found.rewind()
    np.testing.assert_array_equal(found.open, expected)
    other = pores(comm)[1]
    other.restore({name: saved.values for name, saved in found.saved().items()})
    np.testing.assert_array_equal(other.open, expected)


def test_solid_that_melts_in_a_step_opens_too(comm):
    """A skin that its gap has left to the heat within: it has melt at the end of the step."""
    body, found = pores(comm)
    solid = np.isclose(body.points[:, 0], LENGTH)
    half = solid & (body.points[:, 1] > 0.5 * WIDTH)
    given = {"liquid": np.where(solid, 0.0, 1.0), "fed": np.isclose(body.points[:, 0], 0.0)}
    ones = np.ones(len(found.open))
    begin(body, found, melts=half, **given)
    found.change(0.0 * ones, ones, np.where(own(found, solid), 2e3, 0.0))
    np.testing.assert_array_equal(found.open, own(found, half))


def test_nodes_that_chatter_stay_open(comm):
    """After three openings and closings."""
    body, found = pores(comm)
    begin(body, found, fed=np.isclose(body.points[:, 0], 0.0))
    ones, kept = np.ones(len(found.open)), []
    for _ in range(4):
        found.change(0.0 * ones, ones, 2e3 * ones)
        found.change(-1e-6 * ones, ones, 0.0 * ones)
        kept.append(found.open.copy())
    assert not np.any(kept[:3])
    np.testing.assert_array_equal(kept[3], own(found, ~np.isclose(body.points[:, 0], 0.0)))


def test_nodes_that_emptied_cells_cut_off(comm):
    body, found = pores(comm)
    x = body.points[:, 0]
    corners = body.nodes.dofmap.list
    empty = (x[corners] < 0.4 * LENGTH).any(axis=1)
    begin(body, found, conducts=~empty, empty=empty, fed=np.isclose(x, LENGTH))
    np.testing.assert_array_equal(found.open, own(found, x < 0.4 * LENGTH))
