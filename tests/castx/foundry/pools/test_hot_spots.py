"""Hot spots of a cylinder whose top is free: what feeds, their volume, their table."""

from __future__ import annotations

import csv
import io
import math

from mpi4py import MPI

import numpy as np
import pytest

from castx.foundry.pools.feeding_surfaces import FeedingSurfaces
from castx.foundry.pools.hot_spots import HotSpots
from castx.foundry.pools.pooled_metal import PooledMetal
from castx.results.states.snapshot import ProcessState
from tests.castx.fakes import FakeSnapshot, casting_pairs, cylinder_mesh

RADIUS, MIDDLE = 0.012, 0.018
FACING = {"casting/mould": "mould"}


@pytest.fixture(scope="module")
def mesh():
    return cylinder_mesh(MPI.COMM_WORLD)


def ball(x, radius=RADIUS, height=MIDDLE):
    """Return f = ρ²/a² in a ball on the axis, one outside."""
    return np.minimum((x[:, 0] ** 2 + (x[:, 1] - height) ** 2) / radius**2, 1.0)


def state(mesh, fraction, time=0.0, renewed=()):
    process = ProcessState(renewed=frozenset(renewed))
    formulas = {"solid_fraction": fraction}
    return FakeSnapshot(time, 0, mesh, casting_pairs(mesh), formulas, process=process)


def metal(limit=1.0, shrinkage=0.05, **surfaces):
    return {"casting": PooledMetal(limit, shrinkage, FeedingSurfaces(**surfaces))}


def test_the_volume_of_a_ball_of_liquid_is_exact_with_finer_meshes(comm):
    """Liquid 1 - ρ²/a² in a ball: 8 π a³/15."""
    exact = 8.0 * math.pi * RADIUS**3 / 15.0
    errors = []
    for size in (2e-3, 1e-3):
        mesh = cylinder_mesh(comm, size=size)
        spots = HotSpots(mesh, metal(facing=FACING))
        spots.update(state(mesh, ball))
        (spot,) = spots.ranked
        errors.append(abs(spot.pool.isolation.volume / exact - 1.0))
        assert spot.deficit == pytest.approx(0.05 * spot.pool.isolation.volume, rel=1e-12)
        # The axis is r = 0, and the centroid of a meridian's liquid lies off it.
        assert spot.pool.isolation.centre[1] == pytest.approx(MIDDLE, abs=0.1 * size)
        assert spot.pool.place == pytest.approx((0.0, MIDDLE), abs=size)
    assert errors[0] < 2e-2 and errors[1] < 0.4 * errors[0]


@pytest.mark.parametrize(
    ("surfaces", "isolated"),
    [
        ({"facing": FACING, "shut": ("base",)}, False),
        ({"facing": FACING, "shut": ("base", "top")}, True),
        ({"named": ("top",)}, False),
        ({"named": ("base",)}, True),
        ({"named": ()}, True),
    ],
)
def test_a_column_below_the_top_is_fed_by_what_is_free_there(mesh, surfaces, isolated):
    spots = HotSpots(mesh, metal(0.5, **surfaces))
    spots.update(state(mesh, lambda x: np.where((x[:, 0] < 0.01) & (x[:, 1] > 0.01), 0.0, 1.0)))
    assert len(spots.ranked) == isolated


def test_the_axis_is_no_surface_and_the_mould_closes_while_it_is_there(mesh):
    """A pool on the axis touches nothing; one at the side is open where the mould is gone."""
    spots = HotSpots(mesh, metal(0.5, facing=FACING))
    spots.update(state(mesh, ball))
    assert len(spots.ranked) == 1
    side = state(mesh, lambda x: np.where(np.abs(x[:, 1] - 0.02) < 0.01, 0.2, 1.0))
    spots = HotSpots(mesh, metal(0.5, facing=FACING))
    spots.update(side)
    assert len(spots.ranked) == 1
    side.pairs.clear()
    spots.update(side)
    assert not spots.ranked


def test_the_field_is_the_number_of_the_pool(mesh):
    spots = HotSpots(mesh, metal(0.5, facing=FACING))
    spots.update(state(mesh, ball))
    points = mesh.bodies["casting"].points
    inside = ball(points) < 0.5
    numbers = spots.numbers("casting")
    assert (numbers[inside] == 1).all() and np.isnan(numbers[~inside]).all()
    assert spots.numbers("mould") is None


def test_a_renewed_body_begins_again(mesh):
    spots = HotSpots(mesh, metal(0.5, facing=FACING))
    spots.update(state(mesh, ball))
    spots.update(state(mesh, lambda x: ball(x, 0.5 * RADIUS), 1.0, ["casting"]))
    (spot,) = spots.ranked
    assert spot.pool.number == 1 and spot.pool.isolation.time == 1.0


@pytest.mark.ranks
def test_the_table_lists_them_by_rank(mesh):
    def two(x):
        return np.minimum(ball(x, 0.006, 0.008), ball(x, 0.009, 0.028))

    spots = HotSpots(mesh, metal(0.9, facing=FACING))
    spots.update(state(mesh, two))
    spots.update(state(mesh, lambda x: np.maximum(two(x), np.where(x[:, 1] < 0.017, 1, 0)), 2.0))
    rows = list(csv.DictReader(io.StringIO(spots.table())))
    assert [row["rank"] for row in rows] == ["1", "2"]
    assert float(rows[0]["last.z"]) == pytest.approx(0.028, abs=4e-3) and not rows[0]["ended"]
    assert 0.0 < float(rows[1]["ended"]) < 2.0
    for row, spot in zip(rows, spots.described(), strict=True):
        assert float(row["volume"]) == spot["volume"]
        assert float(row["deficit"]) == spot["deficit"] == pytest.approx(0.05 * spot["volume"])
        assert [float(row[f"last.{axis}"]) for axis in "rz"] == spot["place"]
