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
        "liquid": np.ones(nodes), "freezes": all_nodes, "conducts": np.ones(cells, dtype=bool),
        "fed": ~all_nodes, "empty": np.zeros(cells, dtype=bool),
    }  # fmt: skip
    found.begin(**{**state, **given})


def own(found: PoreSet, mask: BoolArray) -> BoolArray:
    return mask[: len(found.open)]


@pytest.mark.ranks
def test_highest_nodes_of_pools_that_nothing_reaches(comm):
    """Two pools that a solid middle parts; one of them is fed."""
    body, found = pores(comm)
    x, y = body.points[:, 0], body.points[:, 1]
    solid = np.isclose(x, LENGTH / 2)
    corners = body.nodes.dofmap.list
    conducts = ~solid[corners].any(axis=1)
    liquid = np.where(solid, 0.0, 0.5)
    begin(body, found, liquid=liquid, conducts=conducts, fed=np.isclose(x, 0.0))
    expected = np.isclose(y, WIDTH) & (x > 0.6 * LENGTH)
    np.testing.assert_array_equal(found.open, own(found, expected))


@pytest.mark.ranks
def test_melt_that_rests_keeps_its_pressure_until_it_lacks_volume(comm):
    body, found = pores(comm)
    top = own(found, np.isclose(body.points[:, 1], WIDTH))
    begin(body, found, freezes=np.zeros(len(body.points), dtype=bool))
    np.testing.assert_array_equal(found.resting, top)
    assert not found.open.any()
    volumes, none = np.ones(len(top)), np.zeros(len(top))
    assert not found.change(none, volumes, none)
    assert found.change(1e-6 * volumes, volumes, none) == top.any()
    np.testing.assert_array_equal(found.open, top)
    assert not found.resting.any()


def test_without_weight_all_nodes_are_highest(comm):
    body, found = pores(comm, np.zeros(2))
    begin(body, found)
    assert found.open.all()


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
    assert changed == expected.any()
    np.testing.assert_array_equal(found.open, expected)
    found.commit()
    found.change(-1e-6 * ones, ones, 1e3 * ones)
    assert not found.open.any()
    found.rewind()
    np.testing.assert_array_equal(found.open, expected)
    other = pores(comm)[1]
    other.restore({name: saved.values for name, saved in found.saved().items()})
    np.testing.assert_array_equal(other.open, expected)


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
