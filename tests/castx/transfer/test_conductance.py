"""States of pairs, their faces, and laws of one number."""

from __future__ import annotations

import numpy as np
import pytest

from castx.transfer.conductance import (
    PRIMARY,
    SECONDARY,
    SOLID,
    ConstantConductance,
    Faces,
)
from castx.transfer.pair_state import PairState

pytestmark = pytest.mark.serial


def faces(count=3):
    hot, cold = 400.0 + np.arange(count), 100.0 + 10.0 * np.arange(count)
    return Faces.at_temperatures(hot, cold, 7.0, 0.4)


def test_temperatures_and_solid_fraction_are_the_variables():
    found = faces()
    mean = found.temperature("mean")
    np.testing.assert_array_equal(mean.value, [250.0, 255.5, 261.0])
    np.testing.assert_array_equal(mean.slopes[[SECONDARY, PRIMARY, SOLID]],
                                  [[0.5] * 3, [0.5] * 3, [0.0] * 3])  # fmt: skip
    assert found.temperature("secondary") is found.secondary
    assert found.temperature("primary") is found.primary
    np.testing.assert_array_equal(found.solid_fraction.slopes[SOLID], 1.0)


def test_a_part_of_the_pairs():
    points = np.array([2, 0])
    part, state = faces().at(points), PairState.of(np.arange(3.0), np.zeros(3)).at(points)
    np.testing.assert_array_equal(part.secondary.value, [402.0, 400.0])
    np.testing.assert_array_equal(state.gap, [2.0, 0.0])
    assert part.time == 7.0


def test_one_coefficient_touches_where_pairs_are_closed():
    found = ConstantConductance(200.0)(PairState.of(np.array([0.0, 1e-5]), np.zeros(2)), faces(2))
    np.testing.assert_array_equal(found.coefficient.value, [200.0, 200.0])
    np.testing.assert_array_equal(found.coefficient.slopes, 0.0)
    np.testing.assert_array_equal(found.contact, [1.0, 0.0])
    assert not ConstantConductance().needs_solid_fraction
