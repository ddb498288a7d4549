"""Levels that sink by what their feeders supply, on all ranks together."""

from __future__ import annotations

import numpy as np
import pytest

from castx.mechanics.mush.levels import FeederLevels

pytestmark = pytest.mark.sampled


@pytest.mark.ranks
def test_falls_of_prisms(comm):
    """Each rank has a node of both feeders and one of none; one feeder has no horizontal area."""
    areas = np.array([4e-4, 1e-4, 0.0])
    levels = FeederLevels(comm, "casting", "abc", areas, np.array([0, 1, 1, -1, 2]))
    supply = np.array([1e-6, 2e-7, 3e-7, 7e-6, 1e-6]) / comm.size
    np.testing.assert_allclose(levels.falls(supply), [2.5e-3, 5e-3, 0.0], rtol=1e-12)
    levels.commit(supply)
    levels.commit(supply)
    assert levels.totals() == pytest.approx(
        {
            "level_drop.a": 5e-3, "level_drop.b": 1e-2, "level_drop.c": 0.0,
            "fed_volume.a": 2e-6, "fed_volume.b": 1e-6, "fed_volume.c": 2e-6,
        },
        rel=1e-12, abs=1e-18,
    )  # fmt: skip
    other = FeederLevels(comm, "casting", "abc", areas, np.array([0, 1, 1, -1, 2]))
    other.restore({name: saved.values for name, saved in levels.saved().items()})
    assert other.totals() == levels.totals()
