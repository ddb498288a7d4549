"""Levels of solid fraction on the curve of a eutectic alloy."""

from __future__ import annotations

import pytest

from castx.results.freezing.levels import Level
from tests.castx.results.freezing.test_passing import EUTECTIC, LIQUIDUS, Curve

pytestmark = pytest.mark.serial


def test_levels_on_the_plateau_have_its_ends():
    solidus, niyama, liquidus = (Level.of(Curve(), fraction) for fraction in (1.0, 0.9, 0.0))
    for level in (solidus, niyama):
        assert level.temperature == EUTECTIC
        assert (level.cold, level.hot) == pytest.approx(tuple(Curve.heights[1:3]), rel=1e-12)
    assert liquidus.temperature == pytest.approx(LIQUIDUS, abs=1e-9)
    assert liquidus.hot - liquidus.cold < 1.0
