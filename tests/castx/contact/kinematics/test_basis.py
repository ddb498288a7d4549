"""R and P node by node against dense matrices, on one rank; what is tied across ranks."""

from __future__ import annotations

from typing import NamedTuple

from mpi4py import MPI

import numpy as np
import pytest

from castx.contact.kinematics.basis import BasisMatrices
from castx.contact.kinematics.node_rows import NodeRows
from castx.contact.kinematics.pair_rows import EqualMotion
from castx.solvers.layout import Layout
from tests import small_contact


class Nodes(NamedTuple):
    size_local: int


def ints(*values):
    return np.array(values, dtype=np.int32)


def bodies(*sizes):
    """Return the layout of bodies of two nodes each, and their empty rows."""
    return (
        Layout(MPI.COMM_SELF, [Nodes(2)] * len(sizes), sizes),
        [NodeRows.none(2, 2) for _ in sizes],
    )


def dense(basis):
    R, P = basis.finish()
    found = [matrix.convert("dense").getDenseArray().copy() for matrix in (R, P)]
    np.testing.assert_allclose(found[0] @ found[1], np.eye(len(found[0])), atol=1e-14)
    return found


@pytest.mark.serial
def test_without_rows_nothing_changes():
    layout, rows = bodies(3)
    np.testing.assert_array_equal(dense(BasisMatrices(layout, 2, rows))[0], np.eye(6))


@pytest.mark.serial
def test_a_node_is_expressed_in_its_rows():
    layout, rows = bodies(3)
    n = np.array([0.6, 0.8])
    rows[0].try_add(ints(1), n[None], 0.1)
    R, _ = dense(BasisMatrices(layout, 2, rows))
    np.testing.assert_allclose(R[3, 3:5], n)
    np.testing.assert_allclose(abs(R[4, 3:5]), [0.8, 0.6])
    np.testing.assert_array_equal(R[:3], np.eye(6)[:3])
    np.testing.assert_array_equal(R[5], np.eye(6)[5])


@pytest.mark.serial
def test_a_relative_motion_is_a_row():
    """v_0 = n · (u_0 of the first body - what two nodes of the second move at weights 1/4, 3/4)."""
    layout, rows = bodies(2, 3)
    n = np.array([0.6, 0.8])
    rows[0].try_add(ints(0), n[None], 0.1)
    basis = BasisMatrices(layout, 2, rows)
    partners = np.array([[0, 1]]), np.array([[0.25, 0.75]])
    basis.make_relative(0, ints(0), ints(0), n[None], 1, partners)
    R, _ = dense(basis)
    expected = np.concatenate((n, np.zeros(2), -0.25 * n, [0.0], -0.75 * n, [0.0]))
    np.testing.assert_allclose(R[0], expected)


@pytest.mark.serial
def test_chains_of_pairs_end():
    """A node of the first body on the second, which stands on the third."""
    layout, rows = bodies(2, 2, 2)
    n = np.array([0.0, 1.0])
    for b in (0, 1):
        rows[b].try_add(ints(0), n[None], 0.1)
    basis = BasisMatrices(layout, 2, rows)
    for b in (0, 1):
        local = ints(layout.local_slice(b).start)
        partners = np.array([[0]]), np.ones((1, 1))
        basis.make_relative(b, ints(0), local, n[None], b + 1, partners)
    _, P = dense(basis)
    # A unit motion of the lowest node lifts all three.
    lifted = P[[1, 5, 9], layout.local_slice(2).start + 1]
    np.testing.assert_allclose(lifted, 1.0)


@pytest.mark.serial
def test_tied_rows_are_differences_to_the_first():
    layout, rows = bodies(3)
    e = np.array([0.0, 1.0])
    slots = rows[0].try_add(ints(0, 1), np.array([e, e]), 0.1)
    basis = BasisMatrices(layout, 2, rows)
    local = basis.tie(EqualMotion(0, ints(0, 1), slots, 0))
    np.testing.assert_array_equal(local, [3])
    R, _ = dense(basis)
    np.testing.assert_allclose(R[3], [0, -1, 0, 0, 1, 0], atol=1e-15)


@pytest.mark.serial
def test_a_tied_component_is_a_difference_to_the_first_node():
    layout, rows = bodies(3)
    basis = BasisMatrices(layout, 2, rows)
    np.testing.assert_array_equal(basis.tie_component(0, 2), [5])
    np.testing.assert_array_equal(dense(basis)[0][5], [0, 0, -1, 0, 0, 1])


@pytest.mark.serial
def test_matrices_are_filled_without_making_room_on_the_way():
    layout, rows = bodies(3, 3)
    n = np.array([0.6, 0.8])
    rows[0].try_add(ints(0, 1), np.tile(n, (2, 1)), 0.1)
    basis = BasisMatrices(layout, 2, rows)
    basis.make_relative(
        0, ints(0, 1), ints(0, 3), np.tile(n, (2, 1)), 1, (np.array([[0], [1]]), np.ones((2, 1)))
    )
    R, _ = basis.finish()
    assert R.getInfo()["mallocs"] == 0 and R.getInfo()["nz_unneeded"] == 0


@pytest.mark.serial
def test_the_coupling_is_what_rows_have_of_the_points_that_they_face():
    """Nothing of their own node: with it subtracted, a row is that of a node without a pair."""
    layout, rows = bodies(3, 2)
    n = np.array([0.6, 0.8])
    for nodes in rows:
        nodes.try_add(ints(1), n[None], 0.1)
    alone, _ = dense(BasisMatrices(layout, 2, rows))
    basis = BasisMatrices(layout, 2, rows)
    partners = np.array([[0, 1]]), np.array([[0.25, 0.75]])
    basis.make_relative(0, ints(1), ints(3), n[None], 1, partners)
    R, P = basis.finish()
    coupling = basis.coupling(P)
    found = coupling.convert("dense").getDenseArray()
    both = [made.convert("dense").getDenseArray() for made in (R, P)]
    np.testing.assert_allclose(found, (both[0] - alone) @ both[1], atol=1e-14)
    assert np.count_nonzero(abs(found).max(axis=1)) == 1 and abs(found[3]).max() > 0.2


@pytest.mark.serial
def test_without_pairs_there_is_no_coupling():
    layout, rows = bodies(3)
    basis = BasisMatrices(layout, 2, rows)
    assert basis.coupling(basis.finish()[1]) is None


def on_the_last(comm):
    """Return the layout of a body whose two nodes are on the last rank, and its empty rows."""
    count = 2 if comm.rank == comm.size - 1 else 0
    return Layout(comm, [Nodes(count)], (3,)), [NodeRows.none(count, 2)], np.arange(count)


@pytest.mark.ranks
def test_ranks_without_nodes_of_a_tied_surface_take_part(comm):
    layout, rows, nodes = on_the_last(comm)
    slots = rows[0].try_add(ints(*nodes), np.tile([0.0, 1.0], (len(nodes), 1)), 0.1)
    basis = BasisMatrices(layout, 2, rows)
    motion = EqualMotion(0, ints(*nodes), slots, 0 if len(nodes) else None)
    np.testing.assert_array_equal(basis.tie(motion), [3] if len(nodes) else [])
    R, _ = basis.finish()
    np.testing.assert_allclose(small_contact.dense(comm, R)[3], [0, -1, 0, 0, 1, 0], atol=1e-15)


@pytest.mark.ranks
def test_ranks_without_nodes_of_a_body_with_a_tied_component_take_part(comm):
    layout, rows, nodes = on_the_last(comm)
    basis = BasisMatrices(layout, 2, rows)
    np.testing.assert_array_equal(basis.tie_component(0, 2), [5] if len(nodes) else [])
    R, _ = basis.finish()
    np.testing.assert_array_equal(small_contact.dense(comm, R)[5], [0, 0, -1, 0, 0, 1])
