"""Rows of the pairs of an interface: which are free, and numbers that outlive the ranks."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from castx.contact.kinematics.pair_rows import PairRows
from castx.contact.kinematics.rows import Treatment

pytestmark = pytest.mark.serial


def rows() -> PairRows:
    """Return two rows of the pair at node 41 and one of that at node 7."""
    pairs: Any = SimpleNamespace(
        name="a/b", secondary="a", primary="b", original_nodes=np.array([41, 7])
    )
    index = np.array([0, 0, 1], dtype=np.int32)
    local = np.array([4, -1, 9], dtype=np.int32)
    none = np.zeros((3, 0), dtype=np.int32)
    return PairRows(
        pairs, index, np.eye(3), np.ones(3), local, Treatment.TIED, np.zeros((3, 0, 3)), none
    )


def test_rows_without_an_unknown_are_not_free():
    np.testing.assert_array_equal(rows().free, [True, False, True])


def test_numbers_tell_node_and_order():
    numbering = rows().numbering
    assert numbering.name == "rows of a/b"
    assert len(set(numbering.numbers)) == 3
    step = numbering.numbers[1] - numbering.numbers[0]
    assert step == 1 and numbering.numbers[0] - numbering.numbers[2] > 64 * (41 - 7) - 64
