"""Friction by a penalty: return mapping by hand, and what is remembered."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.friction.coulomb import SlidingRows
from castx.contact.friction.penalty import PenaltyFriction
from castx.contact.kinematics.iterate import ConstrainedRows, PairIterate
from tests.partitions import PARTITION, along_x
from tests.small_contact import two_blocks

FRICTION, SPRING = 0.3, 1e6


def friction_on(comm):
    """Return friction of three pairs, springs of 1 N/µm along the surface."""
    made = two_blocks(comm, "penalty", friction=FRICTION, solved=False)
    balance = made.equilibrium.balance
    sliding = SlidingRows(made.gaps, [FRICTION])
    friction = PenaltyFriction(
        balance.transform, list(made.bodies), made.gaps, sliding,
        balance.contact.normal.gap_matrix, lambda: np.full(len(made.gaps.local), SPRING),
    )  # fmt: skip
    friction.begin()
    return made, friction, sliding


def at(made, moved, closed=(True, True, True)):
    """Return the iterate with the upper block moved along the surface by metres."""
    u = np.zeros(made.layout.size_local)
    u[made.layout.local_slice(0)].reshape(-1, 3)[:, 0] = moved
    x = made.equilibrium.x.duplicate()
    x.array[:] = made.equilibrium.balance.transform.unknowns(u)
    return PairIterate(x, np.zeros(len(u)), np.zeros(len(closed)), np.array(closed), 1.0)


def force(made, friction, iterate, normal):
    """Return the friction on the upper block [N], and that its rows say the same."""
    rows = ConstrainedRows(np.zeros(made.layout.size_local))
    friction.impose(iterate, np.asarray(normal, dtype=float), rows)
    assert not rows.constrained.any()
    nodal = made.equilibrium.balance.transform.forces_on_nodes(rows.forces)
    upper = nodal[made.layout.local_slice(0)].reshape(-1, 3)[:, 0]
    vectors = friction.vectors(iterate)
    assert upper.sum() == pytest.approx(-vectors[:, 0].sum(), rel=1e-12)
    return vectors[:, 0]


@pytest.mark.serial
def test_pairs_that_stick_are_springs(comm):
    """Moved by 2 µm they pull back by 2 N each, if they are closed."""
    made, friction, _ = friction_on(comm)
    found = force(made, friction, at(made, 2e-6, (True, False, True)), [10.0, 10.0, 10.0])
    np.testing.assert_allclose(found, [-2.0, 0.0, -2.0], rtol=1e-9)


@pytest.mark.serial
def test_forces_beyond_the_friction_are_scaled_back(comm):
    """μ p S is 3, 1.5 and 0 N."""
    made, friction, _ = friction_on(comm)
    iterate, normal = at(made, 2e-6), np.array([10.0, 5.0, 0.0])
    force(made, friction, iterate, normal)
    # Pairs that have come into contact and have moved slip at once.
    assert friction.update(iterate, normal, 1e-9, settled=True) or not friction.sticking().all()
    np.testing.assert_array_equal(friction.sticking(), [True, False, False])
    np.testing.assert_allclose(
        force(made, friction, iterate, normal), [-2.0, -1.5, 0.0], rtol=1e-9, atol=1e-12
    )


@pytest.mark.serial
def test_tractions_go_on_from_the_last_accepted_step(comm):
    made, friction, _ = friction_on(comm)
    normal = np.full(3, 100.0)
    first, second = at(made, 2e-6), at(made, 5e-6)
    force(made, friction, first, normal)
    friction.commit(first.x)
    np.testing.assert_allclose(force(made, friction, first, normal), -2.0, rtol=1e-9)
    np.testing.assert_allclose(force(made, friction, second, normal), -5.0, rtol=1e-9)
    friction.rewind(first.x)
    np.testing.assert_allclose(force(made, friction, first, normal), -2.0, rtol=1e-9)


@pytest.mark.serial
def test_memory(comm):
    made, friction, _ = friction_on(comm)
    iterate, normal = at(made, 2e-6), np.full(3, 100.0)
    force(made, friction, iterate, normal)
    friction.commit(iterate.x)
    saved = friction.saved()
    made, other, _ = friction_on(comm)
    other.restore(saved)
    other.rewind(iterate.x)
    np.testing.assert_allclose(force(made, other, iterate, normal), -2.0, rtol=1e-9)


@pytest.mark.serial
def test_only_closed_pairs_that_stick_constrain_motions(comm):
    made, friction, _ = friction_on(comm)
    motion = at(made, 1.0).x.array_r
    found = friction.constraint_values(np.array([motion]), np.array([True, False, True]))
    np.testing.assert_allclose(np.abs(found), [[1.0, 1.0]], rtol=1e-12)


@pytest.mark.ranks
def test_a_pair_that_slips_on_one_rank_is_a_change_on_all(comm, monkeypatch):
    """Pulled back by 2 N each, the pair at the right end bears 1.5 N at most."""
    monkeypatch.setattr(PARTITION, along_x)
    made, friction, _ = friction_on(comm)
    right = at_right(made)
    iterate, normal = at(made, 2e-6, np.ones(len(right), dtype=bool)), np.where(right, 5.0, 10.0)
    force(made, friction, at(made, 0.0, iterate.closed), normal)
    assert not friction.update(iterate, normal, 1e-9, settled=True)
    force(made, friction, iterate, normal)
    assert friction.update(iterate, normal, 1e-9, settled=True)
    np.testing.assert_array_equal(friction.sticking(), ~right)


@pytest.mark.ranks
def test_a_pair_that_touches_on_one_rank_lets_all_sets_return(comm, monkeypatch):
    """It slips at once, having moved; the ranks forget together which sets they have seen."""
    monkeypatch.setattr(PARTITION, along_x)
    made, friction, _ = friction_on(comm)
    right = at_right(made)
    apart, iterate = (at(made, 2e-6, closed) for closed in (~right, np.ones_like(right)))
    normal = np.where(right, 5.0, 10.0)
    force(made, friction, apart, normal)
    assert friction.update(iterate, normal, 1e-9, settled=True)
    np.testing.assert_array_equal(friction.sticking(), ~right)


def at_right(made):
    """Return whether pairs are the one at the right end, which belongs to the last rank."""
    return made.pairs[0].points[made.gaps.interfaces[0].index, 0] > 0.005
