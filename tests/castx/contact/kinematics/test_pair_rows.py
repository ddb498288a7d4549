"""Rows of the pairs of an interface: which are free, and numbers that outlive the ranks."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from castx.contact.kinematics.midside_shares import MidsideShares
from castx.contact.kinematics.pair_rows import PairRows
from castx.contact.kinematics.rows import Treatment

pytestmark = pytest.mark.serial


def rows(midsides: Any = ()) -> PairRows:
    """Return two rows of the pair at node 41 and one of that at node 7."""
    pairs: Any = SimpleNamespace(
        name="a/b", secondary="a", primary="b", original_nodes=np.array([41, 7])
    )
    index = np.array([0, 0, 1], dtype=np.int32)
    local = np.array([4, -1, 9], dtype=np.int32)
    none = np.zeros((3, 0), dtype=np.int32)
    return PairRows(
        pairs, index, np.eye(3), np.array([2.0, 0.0, 1.0]), local, Treatment.TIED,
        np.zeros((3, 0, 3)), none, midsides,
    )  # fmt: skip


def test_rows_without_an_unknown_are_not_free():
    np.testing.assert_array_equal(rows().free, [True, False, True])


def test_numbers_tell_node_and_order():
    numbering = rows().numbering
    assert numbering.name == "rows of a/b"
    assert len(set(numbering.numbers)) == 3
    step = numbering.numbers[1] - numbering.numbers[0]
    assert step == 1 and numbering.numbers[0] - numbering.numbers[2] > 64 * (41 - 7) - 64


SHARES = MidsideShares(
    "b", -1.0, np.array([0, 1, 2], dtype=np.int32), np.array([70, 71, 72]),
    np.array([1.0, 1.0, -3.0]), np.array([[0.6, 0.8, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
)  # fmt: skip


def test_mid_sides_count_in_gaps_along_the_vectors_of_their_edges():
    """By their area over that of the pair; the second row has no area."""
    (found,) = rows((SHARES,)).midsides_in_gaps()
    assert found.name == "mid-sides of b"
    np.testing.assert_array_equal(found.rows, [0, 2])
    np.testing.assert_array_equal(found.midsides, [70, 72])
    np.testing.assert_allclose(found.weights, [-0.5, 3.0])
    np.testing.assert_allclose(found.directions, [[0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])


def test_mid_sides_count_in_other_motions_along_these():
    along = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    (found,) = rows((SHARES,)).midsides_along(along)
    np.testing.assert_allclose(found.weights, [-0.5, 3.0])
    np.testing.assert_allclose(found.directions, along[[0, 2]])
