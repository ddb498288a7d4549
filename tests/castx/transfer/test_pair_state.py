"""The record of node pairs that goes from contact to heat and results."""

from __future__ import annotations

import numpy as np
import pytest

from castx.transfer.conductance import touching
from castx.transfer.pair_state import PairState

pytestmark = pytest.mark.serial


def test_penetration_and_tension_count_as_zero():
    state = PairState.of(np.array([-1e-6, 2e-6]), np.array([3e6, -4e6]))
    np.testing.assert_array_equal(state.gap, [0.0, 2e-6])
    np.testing.assert_array_equal(state.pressure, [3e6, 0.0])
    np.testing.assert_array_equal(state.closed, [True, False])
    np.testing.assert_array_equal(touching(state), [1.0, 0.0])


def test_clipped_closes_what_has_no_gap_and_takes_the_gap_of_what_is_closed():
    """A closed pair has a gap of round-off, an open one may overlap in an unfinished state."""
    gap, closed = np.array([1e-19, -1e-7, 3e-5]), np.array([True, False, False])
    pressure, force, none = np.array([2e6, -1.0, 0.0]), np.ones((3, 2)), np.zeros(3)
    found = PairState(gap, pressure, closed, force, none).clipped()
    np.testing.assert_array_equal(found.gap, [0.0, 0.0, 3e-5])
    np.testing.assert_array_equal(found.closed, [True, True, False])
    np.testing.assert_array_equal(found.pressure, [2e6, 0.0, 0.0])
    np.testing.assert_array_equal(found.force, 1.0)


def test_gaps_begin_where_the_surfaces_cease_to_touch():
    gap, none = np.array([1e-5, 3e-5, 5e-5]), np.zeros(3)
    state = PairState(gap, none, np.array([True, False, False]), np.zeros((3, 2)), none)
    found = state.clipped(3e-5)
    np.testing.assert_allclose(found.gap, [0.0, 0.0, 2e-5], rtol=1e-12)
    np.testing.assert_array_equal(found.closed, [True, True, False])


def test_some_of_the_pairs():
    force = np.arange(6.0).reshape(3, 2)
    values, closed = np.arange(3.0), np.arange(3) < 1
    state = PairState(values, 10.0 * values, closed, force, 7.0 * values)
    part = state.at(np.array([2, 0]))
    np.testing.assert_array_equal(part.gap, [2.0, 0.0])
    np.testing.assert_array_equal(part.pressure, [20.0, 0.0])
    np.testing.assert_array_equal(part.closed, [False, True])
    np.testing.assert_array_equal(part.force, force[[2, 0]])
    np.testing.assert_array_equal(part.suction, [14.0, 0.0])
