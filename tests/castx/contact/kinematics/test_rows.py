"""Pairs of an interface in their order at each node."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from castx.contact.kinematics.rows import InterfaceRows

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    "nodes, expected",
    [([3, 5, 3, 3, 5], [[0, 1], [2, 4], [3]]), ([7, 2], [[0, 1]]), ([], [])],
)
def test_order_at_each_node(nodes, expected):
    pairs: Any = SimpleNamespace(secondary_local=np.array(nodes, dtype=np.int32))
    found = [numbers.tolist() for numbers in InterfaceRows(pairs).by_order_at_node()]
    assert found == expected
