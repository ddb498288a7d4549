"""Condensed contact against dense products on two blocks."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.contact.condensed import CondensedContact
from tests.elastic_bodies import blocks, body, elastic, everywhere, fixed, gaps, pressures, problem
from tests.small_contact import SOFT, STIFF, dense, of_all, two_blocks


def test_matrix_against_dense_products(comm):
    made = two_blocks(comm)
    balance = made.equilibrium.balance
    contact, assembly = balance.contact.normal, balance.assembly
    assert isinstance(contact, CondensedContact)
    A, P = assembly.matrix(), balance.transform.P
    contact.update_bodies(A)
    found = dense(comm, contact.matrix(balance.present(made.equilibrium.x)))
    change = dense(comm, P)
    expected = change.T @ dense(comm, A) @ change
    np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())


def test_forces_of_closed_pairs_are_the_residuals_of_their_rows(comm):
    """And their gaps are zero to the last digit; -stiffness times the gap where pairs are open."""
    made = two_blocks(comm)
    balance, x = made.equilibrium.balance, made.equilibrium.x
    balance.residual(x, x.duplicate())
    closed = everywhere(comm, balance.active.closed)
    assert {True, False} == set(closed)
    residual = dense(comm, balance.transform.P).T @ of_all(comm, balance.assembly.residual())
    local = balance.gaps.local + balance.transform.layout.first
    rows = residual[everywhere(comm, local)]
    gap = everywhere(comm, balance.iterate.gaps)
    found = everywhere(comm, balance.trial_forces)
    np.testing.assert_allclose(found[closed], rows[closed], rtol=1e-9)
    np.testing.assert_allclose(found[~closed], -balance.stiffness * gap[~closed], rtol=1e-12)
    assert np.all(gap[closed] == 0.0) and np.all(gap[~closed] > 0.0)


def test_initial_gap_closes_under_load(comm):
    made = problem(
        blocks(comm), {"upper": body(elastic(*SOFT)), "base": body(elastic(*STIFF))},
        {"base": [fixed("bottom")], "upper": [fixed("top", value=-3e-5)]},
        [Contact("upper", "base", initial_gap=lambda x: np.full(len(x), 2e-5))],
    )  # fmt: skip
    made.equilibrium.solve(0.0)
    factor = 1 - SOFT[1] ** 2, 1 - STIFF[1] ** 2
    expected = 1e-5 / (0.03 * factor[0] / SOFT[0] + 0.02 * factor[1] / STIFF[0])
    np.testing.assert_allclose(pressures(comm, made), expected, rtol=1e-8)
    np.testing.assert_allclose(gaps(comm, made), 0.0, atol=1e-15)


@pytest.mark.serial
def test_no_constraint_rows_beside_the_unknowns(comm):
    made = two_blocks(comm)
    contact = made.equilibrium.balance.contact
    motions = np.ones((2, contact.layout.size_local))
    assert contact.constraint_values(motions, made.equilibrium.active.closed) is None
