"""Motions in which bodies fall together, of two masses on a line in the plane."""

from __future__ import annotations

import numpy as np
import pytest

from castx.equilibrium.supports.falling import BodiesTogether, completed

pytestmark = pytest.mark.serial

COMMON = np.array([[1.0, 0, 1, 0], [0, 1.0, 0, 1]])
"""Both masses along x and y; their own motions are x and y of the first, then of the second."""


def together(*weight):
    return BodiesTogether(COMMON, np.array(weight), np.ones(4))


def gram(*rows):
    """Return the products of what the motions do to constraint rows."""
    given = np.array(rows).reshape(-1, 4)
    return given.T @ given


def test_without_constraints_they_fall_in_all_directions():
    np.testing.assert_allclose(np.abs(together(0.0, -5.0).falling(gram())), COMMON)


def test_what_joins_them_does_not_hold_them():
    found = together(0.0, -5.0).falling(gram([1.0, 0, -1, 0], [0, 1.0, 0, -1]))
    np.testing.assert_allclose(np.abs(found), COMMON)


def test_on_a_floor_they_do_not_fall_though_they_may_slide():
    assert len(together(0.0, -5.0).falling(gram([0, 0, 0, 1.0]))) == 0


def test_a_rounded_weight_along_the_floor_makes_nothing_fall():
    assert len(together(5e-11, -5.0).falling(gram([0, 0, 0, 1.0]))) == 0


def test_between_walls_they_fall_and_move_in_no_other_way():
    (along,) = together(1e-12, -5.0).falling(gram([1.0, 0, 0, 0]))
    np.testing.assert_allclose(np.abs(along), [0, 1, 0, 1], atol=1e-14)


def test_without_weight_nothing_falls():
    assert len(together(0.0, 0.0).falling(gram())) == 0


def test_some_motions_are_completed_to_a_basis():
    free = np.linalg.qr(np.random.default_rng(1).normal(size=(4, 3)))[0].T
    first = np.array([[1.0, 2.0, 0.0]]) @ free
    found = completed(first, free)
    np.testing.assert_allclose(found @ found.T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(found @ free.T @ free, found, atol=1e-14)
    np.testing.assert_allclose(np.abs(found[0]), np.abs(first[0]) / np.sqrt(5.0), atol=1e-14)
    assert completed(first[:0], free) is free
