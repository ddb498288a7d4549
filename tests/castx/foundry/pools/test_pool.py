"""Records of pools: there and back through JSON, merged, and ranked."""

from __future__ import annotations

import json

import pytest

from castx.foundry.pools.pool import HotSpot, Isolation, Pool, hot_spot, ranked

BETA = 0.0625


def isolated(number, volume, ended=None):
    return Pool(number, 0.0, isolation=Isolation(1.0, (0.0, 0.1), volume), ended=ended)


def test_the_deficit_is_what_the_liquid_shrinks_by():
    """1e-6 m³ of liquid with β = 0.0625, s = β/(1 + β)."""
    spot = hot_spot("casting", isolated(1, 1e-6), BETA / (1.0 + BETA))
    assert spot.deficit == pytest.approx(5.882353e-8, rel=1e-7)
    assert spot.deficit == pytest.approx(1e-6 * BETA / 1.0625, rel=1e-12)
    assert hot_spot("casting", isolated(1, 1e-6), None).deficit is None
    assert hot_spot("casting", isolated(1, 1e-6), -0.02).deficit == 0.0


@pytest.mark.ranks
def test_hot_spots_are_ranked_by_deficit_then_by_end_then_by_volume():
    known = [(1.0, 9.0, 0.1), (2.0, 1.0, 0.2)]
    unknown = [(5.0, 3.0, None), (1.0, 4.0, None), (1.0, None, None), (2.0, None, None)]
    spots = [
        HotSpot("a", isolated(number, volume, ended), deficit)
        for number, (volume, ended, deficit) in enumerate([*known, *unknown], 1)
    ]
    order = ranked([spots[place] for place in (0, 2, 4, 1, 5, 3)])
    assert [spot.pool.number for spot in order] == [2, 1, 6, 5, 4, 3]


def test_a_record_goes_through_json():
    pool = Pool(3, 1.5, 1, (4, 5), (2,), Isolation(2.5, (0.1, 0.2), 3e-6), 7.0, (0.3, 0.4))
    assert Pool.of(json.loads(json.dumps(pool.notes()))) == pool
    fed = Pool(1, 0.0)
    assert Pool.of(json.loads(json.dumps(fed.notes()))) == fed


def test_isolated_pools_that_merge_lack_what_all_of_them_lacked():
    first = Pool(1, 0.0, isolation=Isolation(3.0, (0.0, 0.0), 1e-6))
    second = Pool(2, 0.0, merged=(4,), isolation=Isolation(2.0, (0.0, 0.4), 3e-6))
    both = first.with_merged([second])
    assert both.number == 1 and both.merged == (2,)
    assert both.isolation is not None
    assert both.isolation.time == 2.0
    assert both.isolation.volume == pytest.approx(4e-6, rel=1e-12)
    assert both.isolation.centre == pytest.approx((0.0, 0.3), rel=1e-12)
    assert first.with_merged([Pool(2, 0.0)]).isolation is None
    assert Pool(1, 0.0).with_merged([second]).isolation is None
