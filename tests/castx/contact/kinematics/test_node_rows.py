"""Rows of nodes: independence, complements and bases against dense algebra."""

from __future__ import annotations

from typing import NamedTuple

from mpi4py import MPI

import numpy as np
import pytest

from castx.contact.kinematics.node_rows import NodeRows, owned_nodes
from castx.solvers.layout import Layout

pytestmark = pytest.mark.serial


class Nodes(NamedTuple):
    size_local: int


def test_owned_nodes():
    layout = Layout(MPI.COMM_SELF, [Nodes(4), Nodes(7)], [3, 2])
    assert [owned_nodes(layout, b) for b in range(2)] == [4, 7]


def unit(*vector):
    return np.array(vector) / np.linalg.norm(vector)


def test_only_independent_rows_are_added():
    rows = NodeRows.none(3, 3)
    nodes = np.array([0, 2], dtype=np.int32)
    first = np.array([unit(1, 0, 0), unit(0, 1, 1)])
    np.testing.assert_array_equal(rows.try_add(nodes, first, 0.1), [0, 0])
    # The sine of the angle to what is there: 0.05 at the first node, 1 at the other.
    second = np.array([unit(1, 0.05, 0), unit(0, 1, -1)])
    np.testing.assert_array_equal(rows.can_add(nodes, second, 0.1), [False, True])
    np.testing.assert_array_equal(rows.try_add(nodes, second, 0.1), [-1, 1])
    np.testing.assert_array_equal(rows.try_add(nodes, second, 0.01), [1, -1])
    np.testing.assert_array_equal(rows.count, [2, 0, 2])
    np.testing.assert_allclose(rows.rows[2, :2], [first[1], second[1]])


def test_a_full_node_takes_no_row():
    rows = NodeRows.none(1, 2)
    node = np.array([0], dtype=np.int32)
    for direction in np.eye(2):
        rows.try_add(node, direction[None], 0.1)
    assert not rows.can_add(node, np.array([unit(1, 1)]), 0.1)[0]


def test_complements_are_orthonormal_and_normal_to_the_rows():
    rows = NodeRows.none(3, 3)
    rows.try_add(np.array([1, 2], dtype=np.int32), np.array([unit(1, 2, 2)] * 2), 0.1)
    rows.try_add(np.array([2], dtype=np.int32), np.array([unit(0, 1, 5)]), 0.1)
    found = rows.complement(np.arange(3, dtype=np.int32))
    np.testing.assert_array_equal(found[0], np.eye(3))
    for node, count in ((1, 2), (2, 1)):
        own = found[node, :count]
        np.testing.assert_allclose(own @ own.T, np.eye(count), atol=1e-14)
        np.testing.assert_allclose(own @ rows.rows[node, : 3 - count].T, 0.0, atol=1e-14)
        assert np.all(found[node, count:] == 0.0)


def test_completed_rows_are_a_basis_and_copies_independent():
    rows = NodeRows.none(2, 3)
    rows.try_add(np.array([1], dtype=np.int32), np.array([unit(1, 1, 0)]), 0.1)
    copy = rows.copy()
    np.testing.assert_array_equal(rows.complete(), [1])
    assert abs(np.linalg.det(rows.rows[1])) == pytest.approx(1.0)
    assert np.all(copy.rows[1, 1:] == 0.0)
