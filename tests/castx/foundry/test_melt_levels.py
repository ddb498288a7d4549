"""Levels of feeders that communicate: one level, and the volumes sum to the demand."""

import numpy as np
import pytest

from castx.foundry.melt_levels import communicating

pytestmark = pytest.mark.serial

AREAS = np.array([4e-4, 1e-4])


def test_two_feeders_at_different_levels():
    level, given = communicating(AREAS, np.array([0.05, 0.04]), 2e-6)
    assert level == pytest.approx(0.044, rel=1e-12)
    np.testing.assert_allclose(given, [2.4e-6, -0.4e-6], rtol=1e-9)


def test_two_feeders_at_one_level():
    level, given = communicating(AREAS, np.array([0.05, 0.05]), 2e-6)
    assert 0.05 - level == pytest.approx(4e-3, rel=1e-9)
    np.testing.assert_allclose(given, [1.6e-6, 0.4e-6], rtol=1e-9)
