"""State of pairs by hand: pressures, no tension, friction, tied pairs."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from castx.contact.kinematics.pair_rows import PairRows
from castx.contact.kinematics.pair_state import contact_state
from castx.contact.kinematics.rows import Treatment

pytestmark = pytest.mark.serial

UP, SIDE = np.array([0.0, 1.0]), np.array([1.0, 0.0])


def placed(index, normals, areas, treatment=Treatment.CONDENSED) -> PairRows:
    count = max(index) + 1
    pairs: Any = SimpleNamespace(
        areas=np.full(count, 2e-4), area_vectors=np.zeros((count, 2)), normals=np.tile(UP, (2, 1))
    )
    rows = len(index)
    return PairRows(
        pairs, np.array(index, dtype=np.int32), np.array(normals), np.array(areas),
        np.arange(rows, dtype=np.int32), treatment, np.zeros((rows, 1, 2)),
        np.full((rows, 1), -1, dtype=np.int32),
    )  # fmt: skip


def test_pressures_are_forces_over_areas_without_tension():
    rows = placed([0, 1], [UP, UP], [2e-4, 5e-4])
    closed, gaps = np.array([True, False]), np.array([0.0, 1e-5])
    state = contact_state(rows, gaps, np.array([30.0, -1e-9]), closed, None)
    np.testing.assert_allclose(state.pressure, [1.5e5, 0.0])
    np.testing.assert_allclose(state.force, [[0.0, 30.0], [0.0, -1e-9]])
    np.testing.assert_array_equal(state.gap, gaps)
    closed[:] = False
    assert state.closed[0]


def test_friction_adds_to_the_force_alone():
    rows = placed([0, 1], [UP, UP], [2e-4, 5e-4])
    friction = np.array([[4.0, 0.0], [0.0, 0.0]])
    state = contact_state(rows, np.zeros(2), np.array([30.0, 10.0]), np.ones(2, bool), friction)
    np.testing.assert_allclose(state.force, [[4.0, 30.0], [0.0, 10.0]])
    np.testing.assert_allclose(state.pressure, [1.5e5, 2e4])


def test_a_tied_pair_presses_along_its_normal():
    """Its rows push by (3, 40) N: 40 N along the normal of 2 cm²."""
    rows = placed([0, 0, 1], [SIDE, UP, UP], [2e-4] * 3, Treatment.TIED)
    closed = np.zeros(3, dtype=bool)
    state = contact_state(rows, np.ones(3), np.array([3.0, 40.0, -7.0]), closed, None)
    np.testing.assert_allclose(state.force, [[3.0, 40.0], [0.0, -7.0]])
    np.testing.assert_allclose(state.pressure, [2e5, 0.0])
    assert np.all(state.closed) and np.all(state.gap == 0.0)


def test_a_wall_pulls_closed_pairs_by_what_liquid_feels():
    rows = placed([0, 1], [UP, UP], [2e-4, 5e-4])
    gaps, force, felt = np.zeros(2), np.array([30.0, -9.0]), np.array([-4.0, -5.0])
    for closed, expected in ((np.ones(2, bool), [2e4, 1e4]), (np.arange(2) < 1, [2e4, 0.0])):
        state = contact_state(rows, gaps, force, closed, None, felt)
        np.testing.assert_allclose(state.suction, expected)
        np.testing.assert_allclose(state.force[:, 1], force)
    np.testing.assert_allclose(contact_state(rows, gaps, force, closed, None).suction, 0.0)
    tied = placed([0, 1], [UP, UP], [2e-4, 5e-4], Treatment.TIED)
    state = contact_state(tied, gaps, force, closed, None, felt)
    np.testing.assert_allclose(state.suction, [0.0, 4.5e4])


def test_a_liquid_presses_at_least_by_its_column():
    rows = placed([0, 1], [UP, UP], [2e-4, 5e-4])
    force, least = np.array([30.0, -9.0]), np.array([1e3, 2e3])
    state = contact_state(rows, np.zeros(2), force, np.ones(2, bool), None, least=least)
    np.testing.assert_allclose(state.pressure, [1.5e5, 2e3])
    np.testing.assert_allclose(state.force, [[0.0, 30.0], [0.0, -9.0]])
