"""Soft contact: matrix against dense algebra, and a law that is not linear against differences."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.kinematics.iterate import ConstrainedRows, PairIterate
from castx.contact.methods.penalty import LinearPairLaw
from castx.contact.soft import SoftContact
from tests.small_contact import dense, two_blocks, waves

pytestmark = pytest.mark.serial


class Quadratic:
    """A pressure that grows with the square of the penetration, f = ε S g²/L, L = 1 mm."""

    is_linear = False

    def force(self, gaps, areas, stiffness, multipliers):
        return multipliers - stiffness * gaps * np.abs(gaps) / 1e-3

    def slope(self, gaps, areas, stiffness, multipliers):
        return 2 * stiffness * np.abs(gaps) / 1e-3


def soft(made, law):
    """Return soft contact with ε of 1e12 Pa/m and λ of 1 MPa, and P."""
    gaps, transform = made.gaps, made.equilibrium.balance.transform
    contact = SoftContact(
        transform, gaps, [law], lambda: 1e12 * gaps.areas, lambda: 1e6 * gaps.areas
    )
    contact.update_bodies(made.equilibrium.balance.assembly.matrix())
    return contact


def iterate_at(made, contact, x) -> PairIterate:
    u = made.layout.create_vector()
    contact.unknowns.displacements(x, u)
    gaps = contact.gaps(x, u)
    rows = np.zeros(x.getLocalSize())
    return PairIterate(x, rows, gaps, gaps < np.median(gaps) + 1e-12, 1.0)


@pytest.mark.parametrize("law", [LinearPairLaw(), Quadratic()])
def test_matrix_against_dense_products(comm, law):
    made = two_blocks(comm, "penalty")
    contact = soft(made, law)
    assert contact.is_linear == law.is_linear
    iterate = iterate_at(made, contact, made.equilibrium.x)
    assert {True, False} == set(iterate.closed)
    P = dense(comm, made.equilibrium.balance.transform.P)
    G = dense(comm, made.gaps.matrix) @ P
    areas = made.gaps.areas
    slopes = law.slope(iterate.gaps, areas, 1e12 * areas, 1e6 * areas) * iterate.closed
    A = dense(comm, made.equilibrium.balance.assembly.matrix())
    expected = P.T @ A @ P + G.T @ np.diag(slopes) @ G
    for _ in range(2):
        found = dense(comm, contact.matrix(iterate))
        np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("law", [LinearPairLaw(), Quadratic()])
def test_rows_against_the_matrix(comm, law):
    """The change of what the pairs add to the rows is what they add to the matrix."""
    made = two_blocks(comm, "penalty")
    contact = soft(made, law)
    x = made.equilibrium.x
    base = iterate_at(made, contact, x)
    direction = x.duplicate()
    direction.array[:] = 1e-9 * waves(x)
    added = []
    for sign in (1.0, -1.0):
        trial = x.copy()
        trial.axpy(sign, direction)
        moved = iterate_at(made, contact, trial)
        moved = PairIterate(trial, moved.rows, moved.gaps, base.closed, 1.0)
        rows = ConstrainedRows(np.zeros(x.getLocalSize()))
        contact.impose(moved, contact.trial_forces(moved), rows)
        added.append(rows.forces)
        assert not rows.constrained.any()
    product = x.duplicate()
    contact.matrix(base).mult(direction, product)
    transform = made.equilibrium.balance.transform
    bodies = made.equilibrium.balance.assembly.matrix().ptap(transform.P)
    without = x.duplicate()
    bodies.mult(direction, without)
    expected = product.array_r - without.array_r
    scale = np.abs(expected).max()
    assert scale > 0
    np.testing.assert_allclose((added[0] - added[1]) / 2, expected, atol=1e-6 * scale)
