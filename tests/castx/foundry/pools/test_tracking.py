"""Pools in columns of a slab of squares: volumes, places and times by hand."""

from __future__ import annotations

import json

from mpi4py import MPI

import numpy as np
import pytest

from castx.foundry.pools.tracking import BodyPools
from tests.castx.foundry.pools.test_joined_nodes import SIZE, box

WIDTH, LIMIT = 0.004, 0.7


@pytest.fixture(scope="module")
def slab():
    """Thirteen columns of nodes; metal feeds from the first one."""
    return box(MPI.COMM_WORLD, "quadrilaterals")


def columns(body, of):
    """Return the solid fraction of nodes: those of some columns, one elsewhere."""
    x = np.round(body.points[:, 0] / SIZE).astype(int)
    return np.array([of.get(int(column), 1.0) for column in x])


def feeds(body):
    return body.points[:, 0] < 0.5 * SIZE


def liquid(columns, fraction):
    return dict.fromkeys(columns, fraction)


COURSE = [
    liquid(range(13), 0.0),
    liquid(range(4), 0.2) | liquid(range(5, 13), 0.2),
    liquid([6], 0.4) | liquid([10, 11], 0.4),
    liquid(range(6, 12), 0.5),
]
"""All is liquid; it splits; the part that is cut off splits again; its parts melt together."""


def follow(pools, body, states, begin=0):
    for time, state in enumerate(states, begin):
        pools.update(float(time), columns(body, state), feeds(body))
    return pools


def of_number(pools):
    return {pool.number: pool for pool in pools.known}


def new(body):
    return BodyPools(body, "plane-strain", LIMIT)


def test_a_pool_that_is_fed_is_not_isolated(slab):
    (pool,) = follow(new(slab), slab, COURSE[:1]).known
    assert (pool.number, pool.parent, pool.isolation) == (1, None, None)


@pytest.mark.ranks
def test_a_pool_that_is_cut_off_is_isolated_with_its_volume_and_centre(slab):
    """Of the columns 5 to 12 the last one has half a width; 0.86 of them is liquid at 0.7 s."""
    known = of_number(follow(new(slab), slab, COURSE[:2]))
    assert known[2].parent == 1 and known[2].isolation is None
    assert known[1].children == (2,)
    isolation = known[1].isolation
    assert isolation.time == pytest.approx(0.7, abs=2**-12)
    assert isolation.volume == pytest.approx(0.86 * 7.5 * SIZE * WIDTH, rel=1e-4)
    centre = (np.arange(5, 13) @ [1, 1, 1, 1, 1, 1, 1, 0.5]) / 7.5
    assert isolation.centre == pytest.approx((centre * SIZE, 0.5 * WIDTH), rel=1e-12)


def test_parts_of_an_isolated_pool_are_isolated_from_when_they_split(slab):
    """The part with more liquid goes on as pool 1, which keeps the record of its isolation."""
    pools = follow(new(slab), slab, COURSE[:3])
    known = of_number(pools)
    assert sorted(known) == [1, 3], "pool 2 was fed to its end, and lacks nothing"
    assert known[1].isolation.time == pytest.approx(0.7, abs=2**-12)
    assert known[3].parent == 1 and known[3].isolation.time == 2.0
    assert known[3].isolation.volume == pytest.approx(0.6 * SIZE * WIDTH, rel=1e-12)
    assert known[1].children == (2, 3)
    x = np.round(slab.points[:, 0] / SIZE)
    expected = np.where(x == 6, 3, np.where((x == 10) | (x == 11), 1, 0))
    assert np.array_equal(pools.numbers, expected)


def test_the_part_with_more_liquid_goes_on_though_it_has_fewer_nodes(slab):
    states = [*COURSE[:2], liquid([6, 7], 0.65) | liquid([10], 0.0)]
    pools = follow(new(slab), slab, states)
    x = np.round(slab.points[:, 0] / SIZE)
    assert (pools.numbers[x == 10] == 1).all() and (pools.numbers[x == 6] == 3).all()


@pytest.mark.ranks
def test_pools_that_merge_keep_the_lowest_number_and_all_that_they_lack(slab):
    known = of_number(follow(new(slab), slab, COURSE))
    assert sorted(known) == [1]
    assert known[1].merged == (3,) and known[1].ended is None
    assert known[1].isolation.time == pytest.approx(0.7, abs=2**-12)
    volume = (0.86 * 7.5 + 0.6) * SIZE * WIDTH
    assert known[1].isolation.volume == pytest.approx(volume, rel=1e-4)


def test_a_pool_that_is_joined_again_to_what_feeds_it_lacks_nothing(slab):
    states = [*COURSE[:2], liquid(range(13), 0.3), liquid(range(7, 13), 0.3)]
    joined = of_number(follow(new(slab), slab, states[:3]))
    assert sorted(joined) == [1] and joined[1].isolation is None and joined[1].merged == (2,)
    again = of_number(follow(new(slab), slab, states))
    assert again[1].isolation.time == pytest.approx(2 + 0.4 / 0.7, abs=2**-12)
    assert again[1].isolation.volume == pytest.approx(0.7 * 5.5 * SIZE * WIDTH, rel=1e-12)


def test_the_end_is_where_and_when_the_last_node_passes_the_limit(slab):
    """Within the last step, from 3 to 5 s, solid fractions rise linearly: (0.7 - 0.1)/0.9 of it."""
    x, y = np.round(slab.points / SIZE).T
    pools = follow(new(slab), slab, COURSE[:3])
    last = np.where((x == 9) & (y == 3), 0.1, columns(slab, COURSE[3]))
    pools.update(3.0, last, feeds(slab))
    assert pools.known[0].place == pytest.approx((9 * SIZE, 3 * SIZE), rel=1e-12)
    pools.update(5.0, np.ones(len(x)), feeds(slab))
    (pool,) = pools.known
    assert pool.ended == pytest.approx(3.0 + 2.0 * 0.6 / 0.9, rel=1e-12)
    assert pool.place == pytest.approx((9 * SIZE, 3 * SIZE), rel=1e-12)
    assert not pools.numbers.any()


def test_of_places_with_the_same_end_the_first_node_is_taken(slab, comm):
    """Rounding would else choose, and so the number of ranks."""
    places = []
    for ranks, tone in ((MPI.COMM_SELF, 1.0), (MPI.COMM_SELF, 2.0), (comm, 3.0)):
        body = box(ranks, "quadrilaterals")
        pools = follow(new(body), body, COURSE[:3])
        noise = 1e-9 * np.sin(tone * np.arange(len(body.points)))
        pools.update(3.0, columns(body, COURSE[2]) + noise, feeds(body))
        pools.update(4.0, 1.0 + noise, feeds(body))
        places.append([pool.place for pool in pools.known])
    assert places[0] == places[1] == places[2] and len(places[0]) == 2


def test_a_new_body_has_new_pools(slab):
    pools = follow(new(slab), slab, COURSE[:3])
    pools.begin()
    (pool,) = follow(pools, slab, COURSE[:1], 10).known
    assert (pool.number, pool.began, pool.isolation) == (1, 10.0, None)


@pytest.mark.parametrize("stop", [1, 2, 3, 4])
def test_a_record_goes_on_behind_a_checkpoint(slab, stop):
    states = [*COURSE, liquid([7], 0.6), {}]
    whole = follow(new(slab), slab, states)
    half = follow(new(slab), slab, states[:stop])
    second = new(slab)
    arrays = {name: saved.values.copy() for name, saved in half.saved().items()}
    second.restore(arrays, json.loads(json.dumps(half.notes())))
    assert follow(second, slab, states[stop:], stop).known == whole.known
    assert len(whole.known) == 1 and whole.known[0].ended is not None
