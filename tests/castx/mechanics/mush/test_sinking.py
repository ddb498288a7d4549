"""The block of sinking levels against its dense matrix."""

from __future__ import annotations

import numpy as np
import pytest

from castx.mechanics.mush.levels import FeederLevels
from castx.mechanics.mush.sinking import SinkingLevels

pytestmark = pytest.mark.sampled


@pytest.mark.ranks
def test_product_with_unknowns(comm):
    areas = np.array([0.5, 0.0, 0.25])
    levels = FeederLevels(comm, "casting", "abc", areas, np.zeros(0, dtype=np.int32))
    sinking = SinkingLevels(comm, levels)
    assert sinking.sinks
    rng = np.random.default_rng(comm.rank)
    forces, supplies, x = rng.random((3, 4)), rng.random((3, 4)), rng.random(4)
    sinking.begin(forces)
    y = np.ones(4)
    sinking.add_product(x, y)
    np.testing.assert_array_equal(y, 1.0)
    sinking.update(supplies)
    sinking.add_product(x, y)
    falls = comm.allreduce(supplies @ x) * [2.0, 0.0, 4.0]
    np.testing.assert_allclose(y, 1.0 + falls @ forces, rtol=1e-12)


def test_levels_without_area_stay(comm):
    levels = FeederLevels(comm, "casting", "a", np.zeros(1), np.zeros(1, dtype=np.int32))
    assert not SinkingLevels(comm, levels).sinks
