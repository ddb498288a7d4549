"""Multipliers against the dense saddle-point system, on one rank."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.multipliers import AUGMENTATION, MultiplierContact
from tests.small_contact import dense, of_all, two_blocks, waves

pytestmark = pytest.mark.serial


def parts(comm):
    """Return the solved problem, its contact, P and B = -S ∂g/∂v in the units of the unknowns."""
    made = two_blocks(comm, "multipliers")
    balance = made.equilibrium.balance
    contact = balance.contact.normal
    assert isinstance(contact, MultiplierContact)
    P = dense(comm, balance.transform.P)
    B = -contact.unknowns.scales[:, None] * (dense(comm, made.gaps.matrix) @ P)
    return made, contact, P, B


def test_saddle_point_matrix(comm):
    made, contact, P, B = parts(comm)
    balance = made.equilibrium.balance
    A = balance.assembly.matrix()
    contact.update_bodies(A)
    found = dense(comm, contact.matrix(balance.present(made.equilibrium.x)))
    zero = np.zeros((len(B), len(B)))
    expected = np.block([[P.T @ dense(comm, A) @ P, B.T], [B, zero]])
    np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())


def test_residual_and_gaps(comm):
    made, contact, P, B = parts(comm)
    unknowns, assembly = contact.unknowns, made.equilibrium.balance.assembly
    x, r = made.equilibrium.x.duplicate(), assembly.residual_vector.duplicate()
    x.array[:], r.array[:] = 1e-5 * waves(x), 1e3 * waves(r, 1.3)
    v, pressures = np.split(x.array_r, [unknowns.bodies.size_local])
    u = assembly.unknowns.duplicate()
    unknowns.displacements(x, u)
    np.testing.assert_allclose(of_all(comm, u), P @ v, atol=1e-18)
    rows = P.T @ r.array_r + B.T @ pressures
    shut = -unknowns.scales * made.gaps.values(u)
    expected = np.concatenate((rows, shut))
    np.testing.assert_allclose(
        unknowns.residual(x, r), expected, atol=1e-12 * np.abs(expected).max()
    )
    np.testing.assert_allclose(contact.gaps(x, u), made.gaps.initial + dense(
        comm, made.gaps.matrix) @ P @ v, atol=1e-18)  # fmt: skip


def test_open_pairs_carry_nothing_and_closed_ones_their_multiplier(comm):
    made, contact, _, _ = parts(comm)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    closed = balance.active.closed
    assert {True, False} == set(closed)
    multipliers = x.array_r[contact.unknowns.bodies.size_local :]
    assert np.all(multipliers[closed] > 0.0)
    # An open pair has a row of its own in a system that is solved by iteration together with all
    # others. What is left of its multiplier is the rounding of BLAS, whose kernel follows the CPU:
    # zero, or less than one rounding of those that carry.
    rounding = np.finfo(float).eps * multipliers[closed].max()
    assert np.all(np.abs(multipliers[~closed]) <= rounding)
    forces = balance.pair_values(x)[1]
    assert np.all(forces[~closed] == 0.0)
    carried = (multipliers * contact.unknowns.scales)[closed]
    np.testing.assert_allclose(forces[closed], carried, rtol=1e-12)


def test_motions_close_the_gaps_of_closed_pairs(comm):
    made, contact, P, _ = parts(comm)
    motions = np.array([waves(made.equilibrium.x, f) for f in (0.3, 0.9)])
    closed = made.equilibrium.active.closed
    size = contact.unknowns.bodies.size_local
    opened = (dense(comm, made.gaps.matrix) @ P @ motions[:, :size].T).T[:, closed]
    found = contact.constraint_values(motions, closed)
    np.testing.assert_allclose(found, -opened, atol=1e-13)


def test_unknowns_of_the_bodies_come_first_and_weights_are_shares_of_the_scales(comm):
    _, contact, _, B = parts(comm)
    v = np.arange(2.0 * contact.unknowns.bodies.size_local).reshape(2, -1)
    found = contact.unknowns.extended(v)
    np.testing.assert_array_equal(found, np.hstack((v, np.zeros((2, len(B))))))
    np.testing.assert_allclose(contact.schur_weights() * AUGMENTATION, contact.unknowns.scales)
