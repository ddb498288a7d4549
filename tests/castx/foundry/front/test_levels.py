"""Levels of solid fraction on the curve of a eutectic alloy."""

from __future__ import annotations

import pytest

from castx.foundry.front.levels import Level
from tests.castx.foundry.front.test_passing import EUTECTIC, LIQUIDUS, Curve

pytestmark = pytest.mark.serial


def test_levels_on_the_plateau_have_its_ends():
    solidus, niyama, liquidus = (Level.of(Curve(), fraction) for fraction in (1.0, 0.9, 0.0))
    for level in (solidus, niyama):
        assert level.temperature == EUTECTIC
        assert (level.cold, level.hot) == pytest.approx(tuple(Curve.heights[1:3]), rel=1e-12)
    assert liquidus.temperature == pytest.approx(LIQUIDUS, abs=1e-9)
    assert liquidus.hot - liquidus.cold < 1.0


def test_a_temperature_is_the_level_of_its_fraction():
    fraction = 0.6 * (LIQUIDUS - 580.0) / (LIQUIDUS - EUTECTIC)
    by_fraction, by_temperature = Level.of(Curve(), fraction), Level.at(Curve(), 580.0)
    assert by_fraction.temperature == pytest.approx(580.0, rel=1e-12)
    assert by_temperature.temperature == 580.0
    assert by_temperature.cold == pytest.approx(by_fraction.cold, rel=1e-12)
    assert by_temperature.hot == pytest.approx(by_temperature.cold, rel=1e-12)


def test_the_temperature_of_a_plateau_has_both_its_ends():
    level = Level.at(Curve(), EUTECTIC)
    assert (level.cold, level.hot) == pytest.approx(tuple(Curve.heights[1:3]), rel=1e-12)
