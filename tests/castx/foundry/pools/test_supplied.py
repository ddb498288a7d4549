"""What feeders owe to their pools: shares, what is empty, what comes back and what is not there."""

from __future__ import annotations

import numpy as np
import pytest

from castx.foundry.pools.supplied import SuppliedMelt

pytestmark = pytest.mark.serial

OPEN = np.array([[True, False], [True, True]])


def given(first, second, empty=(0.0, 0.0)):
    melt = SuppliedMelt(("a", "b"))
    melt.take_over({"a": first, "b": second}, np.array(empty))
    return melt


def test_a_feeder_takes_from_its_pools_by_what_freezes_there():
    melt = given(8.0, 2.0)
    np.testing.assert_allclose(melt.ask(OPEN, np.array([1.0, 3.0]), np.ones(2)), [2.0, 8.0])
    np.testing.assert_allclose(melt.ask(OPEN, np.zeros(2), np.array([3.0, 1.0])), [6.0, 4.0])


def test_what_pools_did_not_have_is_asked_for_again():
    melt = given(8.0, 2.0)
    asked = melt.ask(OPEN, np.array([1.0, 3.0]), np.ones(2))
    melt.pay(0, asked[0])
    melt.pay(1, 0.75 * asked[1])
    np.testing.assert_allclose(melt.owed, [1.5, 0.5])
    melt.take_over({"a": 8.0, "b": 3.0}, np.zeros(2))
    np.testing.assert_allclose(melt.owed, [1.5, 1.5])


def test_what_is_empty_is_taken_off_what_is_given_and_no_more():
    np.testing.assert_allclose(given(8.0, 2.0, (0.5, 3.0)).owed, [7.5, 0.0])


def test_what_a_feeder_takes_back_is_taken_off_what_it_gives_next():
    melt = given(8.0, 2.0)
    for pool, asked in enumerate(melt.ask(OPEN, np.ones(2), np.ones(2))):
        melt.pay(pool, asked)
    melt.take_over({"a": 7.0, "b": 2.0}, np.array([0.3, 0.0]))
    np.testing.assert_allclose(melt.owed, [-1.0, 0.0])
    assert not melt.ask(OPEN, np.ones(2), np.ones(2)).any()
    melt.take_over({"a": 8.5, "b": 2.0}, np.zeros(2))
    np.testing.assert_allclose(melt.owed, [0.5, 0.0])


def test_a_restored_one_goes_on():
    melt, other = given(8.0, 2.0), SuppliedMelt(("a", "b"))
    other.restore(melt.saved())
    for one in (melt, other):
        one.take_over({"a": 9.0, "b": 4.0}, np.zeros(2))
    np.testing.assert_array_equal(other.owed, melt.owed)
    np.testing.assert_allclose(melt.owed, [9.0, 4.0])
