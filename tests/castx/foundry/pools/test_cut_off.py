"""Columns of a slab that freeze at even rates: times and volumes by hand."""

from __future__ import annotations

from itertools import pairwise

from mpi4py.MPI import MAX

import numpy as np
import pytest

from castx.domain.measures import nodal_volumes
from castx.foundry.pools.cut_off import Metal, cut_off, liquid_at
from castx.foundry.pools.joined_nodes import NodeRegions
from tests.castx.foundry.pools.test_joined_nodes import SIZE, box
from tests.castx.foundry.pools.test_tracking import LIMIT, WIDTH, columns, feeds, liquid

COLUMN = SIZE * WIDTH
EVEN = {"rel": 2.0**-10}


def over_a_step(comm, end, start=None):
    """Return a slab of thirteen columns, its metal, and the regions of liquid at the end."""
    body = box(comm, "quadrilaterals")
    before = columns(body, liquid(range(13), 0.0) if start is None else start)
    metal = Metal(
        NodeRegions(body), nodal_volumes(body, "plane-strain"), LIMIT, before, columns(body, end)
    )
    return body, metal, metal.regions.find(metal.end < LIMIT)[1]


def volume_of(comm, metal, pool, region, share):
    return comm.allreduce(float(liquid_at(metal, pool, region, share).sum()))


@pytest.mark.ranks
def test_what_freezes_behind_the_cut_off_belongs_to_the_pool(comm):
    """Column 4 passes the limit at 0.7 of the step, 10 to 12 at 0.7/0.9 of it."""
    end = liquid(range(4), 0.2) | liquid(range(5, 10), 0.2) | liquid(range(10, 13), 0.9)
    body, metal, region = over_a_step(comm, end)
    share = cut_off(metal, region == 1, feeds(body))
    assert share == pytest.approx(0.7, abs=2.0**-12)
    by_hand = 5 * (1 - 0.7 * 0.2) + 2.5 * (1 - 0.7 * 0.9)
    found = volume_of(comm, metal, 1, region, share)
    assert found == pytest.approx(by_hand * COLUMN, **EVEN)
    assert volume_of(comm, metal, 1, region, 1.0) == pytest.approx(5 * 0.8 * COLUMN, rel=1e-12)


@pytest.mark.ranks
def test_pools_that_part_after_their_cut_off_share_what_froze_between_them(comm):
    """Column 8 freezes when they are cut off; 0.37 of it is liquid at the cut-off."""
    end = liquid(range(4), 0.2) | liquid(range(5, 8), 0.2) | {8: 0.9} | liquid(range(9, 13), 0.4)
    body, metal, region = over_a_step(comm, end)
    left = np.array([3 * 0.8, 3.5 * 0.6])
    between = (1 - 0.7 * 0.9) * left / left.sum()
    by_hand = [3 * (1 - 0.7 * 0.2) + between[0], 3.5 * (1 - 0.7 * 0.4) + between[1]]
    for pool, expected in enumerate(by_hand, 1):
        share = cut_off(metal, region == pool, feeds(body))
        found = volume_of(comm, metal, pool, region, share)
        assert found == pytest.approx(expected * COLUMN, **EVEN)


@pytest.mark.ranks
def test_a_pool_has_the_same_volume_by_one_step_and_by_many(comm):
    """Column 4 cuts it off after 0.7; 5 to 7 pass the limit between that and the end."""
    rates = {column: 0.95 - 0.1 * (column - 5) for column in range(5, 13)} | {4: 1.0}
    volumes = []
    for steps in (1, 8, 64):
        for first, last in pairwise(np.linspace(0.0, 1.0, steps + 1)):
            start, end = ({c: rate * time for c, rate in rates.items()} for time in (first, last))
            fed = liquid(range(4), 0.0)
            body, metal, region = over_a_step(comm, end | fed, start | fed)
            pool = comm.allreduce(int(region[body.points[:, 0] > 7.5 * SIZE].max(initial=-1)), MAX)
            if not metal.regions.join(region == pool, feeds(body), metal.end < LIMIT):
                break
        share = cut_off(metal, region == pool, feeds(body))
        volumes.append(volume_of(comm, metal, pool, region, share))
    by_hand = sum((1 - 0.7 * rates[c]) * (0.5 if c == 12 else 1.0) for c in range(5, 13))
    assert volumes == pytest.approx([by_hand * COLUMN] * 3, **EVEN)


@pytest.mark.ranks
def test_a_part_of_an_isolated_pool_is_cut_off_at_the_end_of_the_step(comm):
    body, metal, region = over_a_step(comm, liquid([6], 0.4), liquid(range(5, 9), 0.2))
    assert cut_off(metal, region == 0, feeds(body)) == 1.0
    assert volume_of(comm, metal, 0, region, 1.0) == pytest.approx(0.6 * COLUMN, rel=1e-12)
