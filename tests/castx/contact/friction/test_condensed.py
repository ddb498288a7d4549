"""Friction of condensed contact: what sticks, what slips, and what is remembered."""

from __future__ import annotations

from dataclasses import replace

from mpi4py import MPI

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.contact.friction.condensed import CondensedFriction
from castx.contact.friction.coulomb import SlidingRows
from castx.contact.kinematics.iterate import ConstrainedRows, PairIterate
from tests.elastic_bodies import (
    blocks,
    body,
    elastic,
    everywhere,
    fixed,
    heat,
    motion,
    normal_forces,
    places,
    problem,
)
from tests.partitions import PARTITION, along_x
from tests.small_contact import two_blocks

FRICTION, STIFFNESS = 0.3, 1e9


def friction_on(comm):
    """Return friction of three closed pairs that stick, its rows, and the unknowns at rest."""
    made = two_blocks(comm, friction=FRICTION, solved=False)
    transform = made.equilibrium.balance.transform
    sliding = SlidingRows(made.gaps, [FRICTION])
    friction = CondensedFriction(transform.layout, made.gaps, sliding)
    friction.begin()
    return made, friction, sliding


def at(made, sliding, moved, rows=None):
    """Return the iterate in which pairs have moved along the surface, all closed."""
    x = made.equilibrium.x.duplicate()
    x.array[sliding.local[:, 0]] = moved
    values, count = np.zeros(x.getLocalSize()) if rows is None else rows, len(sliding.rows)
    return PairIterate(x, values, np.zeros(count), np.ones(count, dtype=bool), STIFFNESS)


def imposed(friction, iterate, normal):
    rows = ConstrainedRows(np.zeros(len(iterate.rows)))
    friction.impose(iterate, np.asarray(normal, dtype=float), rows)
    return rows


def carried(made, sliding, forces):
    rows = np.zeros(made.layout.size_local)
    rows[sliding.local[:, 0]] = forces
    return rows


@pytest.mark.serial
def test_pairs_that_stick_are_constrained_where_they_are(comm):
    made, friction, sliding = friction_on(comm)
    moved = np.array([1e-6, 0.0, -2e-6])
    rows = imposed(friction, at(made, sliding, moved), [10.0, 10.0, 10.0])
    local = sliding.local[:, 0]
    assert np.all(rows.constrained[local]) and np.count_nonzero(rows.constrained) == 3
    np.testing.assert_allclose(rows.violation[local], moved)
    assert np.all(rows.forces == 0.0)


@pytest.mark.serial
def test_a_pair_slips_once_its_force_exceeds_the_friction(comm):
    """μ p S is 3 N: at 2 N it sticks, at 4 N it slips and bears 3 N against its motion."""
    made, friction, sliding = friction_on(comm)
    rows = carried(made, sliding, [2.0, 4.0, -4.0])
    normal = np.full(3, 10.0)
    still = at(made, sliding, np.zeros(3), rows)
    imposed(friction, still, normal)
    assert friction.update(still, normal, 1e-6, settled=True)
    np.testing.assert_array_equal(friction.sticking(), [True, False, False])
    slipped = imposed(friction, at(made, sliding, [0.0, -1e-6, 1e-6], rows), normal)
    local = sliding.local[:, 0]
    np.testing.assert_array_equal(slipped.constrained[local], [True, False, False])
    np.testing.assert_allclose(slipped.forces[local], [0.0, -3.0, 3.0])
    vectors = friction.vectors(PairIterate(
        still.x, rows + _normal(made, 10.0), still.gaps, still.closed, STIFFNESS))  # fmt: skip
    np.testing.assert_allclose(vectors @ sliding.tangents[0, 0], [2.0, 3.0, -3.0])


def _normal(made, force):
    rows = np.zeros(made.layout.size_local)
    rows[made.gaps.local] = force
    return rows


@pytest.mark.serial
def test_pairs_begin_to_slip_only_when_the_rows_nearly_balance(comm):
    made, friction, sliding = friction_on(comm)
    still = at(made, sliding, np.zeros(3), carried(made, sliding, [4.0, 4.0, 4.0]))
    normal = np.full(3, 10.0)
    imposed(friction, still, normal)
    assert not friction.update(still, normal, 1e-6, settled=False)
    assert friction.sticking().all()


@pytest.mark.serial
def test_a_pair_that_would_slip_backwards_sticks(comm):
    made, friction, sliding = friction_on(comm)
    rows = carried(made, sliding, [-4.0, -4.0, -4.0])
    normal = np.full(3, 10.0)
    still = at(made, sliding, np.zeros(3), rows)
    imposed(friction, still, normal)
    friction.update(still, normal, 1e-6, settled=True)
    assert not friction.sticking().any()
    back = at(made, sliding, [1e-6, -1e-6, 1e-6], rows)
    imposed(friction, back, normal)
    assert friction.update(back, normal, 1e-6, settled=True)
    np.testing.assert_array_equal(friction.sticking(), [False, True, False])


@pytest.mark.serial
def test_motions_count_from_the_last_accepted_step(comm):
    made, friction, sliding = friction_on(comm)
    first = at(made, sliding, [1e-6, 2e-6, 3e-6])
    friction.commit(first.x)
    second = imposed(friction, at(made, sliding, [4e-6, 4e-6, 4e-6]), np.ones(3))
    np.testing.assert_allclose(second.violation[sliding.local[:, 0]], [3e-6, 2e-6, 1e-6])
    friction.rewind(first.x)
    again = imposed(friction, first, np.ones(3))
    np.testing.assert_allclose(again.violation, 0.0, atol=1e-20)


@pytest.mark.serial
def test_memory(comm):
    made, friction, sliding = friction_on(comm)
    rows = carried(made, sliding, [2.0, 4.0, -4.0])
    normal = np.full(3, 10.0)
    still = at(made, sliding, np.zeros(3), rows)
    imposed(friction, still, normal)
    friction.update(still, normal, 1e-6, settled=True)
    friction.commit(still.x)
    saved = friction.saved()
    np.testing.assert_array_equal(saved["sticks"], [1.0, 0.0, 0.0])
    np.testing.assert_array_equal(saved["sliding_0"], [0.0, -1.0, 1.0])
    _, other, _ = friction_on(comm)
    other.restore(saved)
    other.rewind(still.x)
    np.testing.assert_array_equal(other.sticking(), friction.sticking())


@pytest.mark.serial
def test_a_pair_that_is_pulled_bears_no_friction(comm):
    """μ ⟨p⟩ S: the normal force of a closed pair may pull for an iteration."""
    made, friction, sliding = friction_on(comm)
    rows = carried(made, sliding, [4.0, 4.0, 4.0])
    still = at(made, sliding, np.zeros(3), rows)
    imposed(friction, still, np.full(3, 10.0))
    assert friction.update(still, np.full(3, 10.0), 1e-6, settled=True)
    moved = at(made, sliding, np.full(3, -1e-6), rows)
    pulled = imposed(friction, moved, [-10.0, 0.0, 5.0])
    np.testing.assert_allclose(pulled.forces[sliding.local[:, 0]], [0.0, 0.0, -1.5])


@pytest.mark.ranks
def test_a_pair_that_slips_on_one_rank_is_a_change_on_all(comm, monkeypatch):
    monkeypatch.setattr(PARTITION, along_x)
    made, friction, sliding = friction_on(comm)
    right, normal = at_right(made), np.full(len(sliding.rows), 10.0)
    still = at(made, sliding, 0.0, carried(made, sliding, np.where(right, 4.0, 2.0)))
    imposed(friction, still, normal)
    assert friction.update(still, normal, 1e-6, settled=True)
    np.testing.assert_array_equal(friction.sticking(), ~right)
    assert not friction.update(still, normal, 1e-6, settled=False)


@pytest.mark.ranks
def test_a_pair_that_touches_on_one_rank_lets_all_sets_return(comm, monkeypatch):
    """It slips at once, having moved; the ranks forget together which sets they have seen."""
    monkeypatch.setattr(PARTITION, along_x)
    made, friction, sliding = friction_on(comm)
    right, normal = at_right(made), np.full(len(sliding.rows), 10.0)
    moved = at(made, sliding, 1e-6)
    imposed(friction, replace(moved, closed=~right), normal)
    assert friction.update(moved, normal, 1e-6, settled=True)
    np.testing.assert_array_equal(friction.sticking(), ~right)


def chattering(made, friction, sliding, pairs):
    """Let pairs begin to slip under 10 N and turn back until they chatter; the others stick.

    Returns:
        What each update said, and the pairs that stuck after it.
    """
    normal, found = np.full(len(sliding.rows), 10.0), []
    rows = carried(made, sliding, np.where(pairs, 4.0, 2.0))
    for _ in range(20):
        back = np.where(pairs & ~friction.sticking(), 1e-6, 0.0)
        iterate = at(made, sliding, back, rows)
        imposed(friction, iterate, normal)
        changed = friction.update(iterate, normal, 1e-6, settled=True)
        found.append((changed, tuple(friction.sticking())))
    return found


@pytest.mark.serial
def test_a_pair_that_chatters_is_held_by_a_spring(comm):
    """A tenth of the stiffness, 1e8 N/m, up to μ p S = 3 N and back; without pressure nothing."""
    made, friction, sliding = friction_on(comm)
    normal, local = np.full(3, 10.0), sliding.local[:, 0]
    chattering(made, friction, sliding, np.array([False, True, True]))
    for moved, force in ((1e-9, 0.1), (-2e-8, -2.0), (1e-6, 3.0), (-1e-6, -3.0), (0.0, 0.0)):
        iterate = at(made, sliding, [0.0, moved, moved])
        found = imposed(friction, iterate, normal)
        np.testing.assert_allclose(found.forces[local], [0.0, force, force], atol=1e-15)
        np.testing.assert_array_equal(found.constrained[local], [True, False, False])
        assert not imposed(friction, iterate, -normal).forces.any()
        imposed(friction, iterate, normal)
        assert not friction.update(iterate, normal, 1e-6, settled=True)


@pytest.mark.serial
def test_pairs_whose_springs_hold_begin_the_next_step_sticking(comm):
    """The last one slips on, in the direction of its motion, which is against its former one."""
    made, friction, sliding = friction_on(comm)
    chattering(made, friction, sliding, np.array([False, True, True]))
    end = at(made, sliding, [0.0, 1e-9, 1e-6])
    imposed(friction, end, np.full(3, 10.0))
    friction.update(end, np.full(3, 10.0), 1e-6, settled=True)
    friction.commit(end.x)
    saved = friction.saved()
    np.testing.assert_array_equal(saved["sticks"], [1.0, 1.0, 0.0])
    assert saved["sliding_0"][2] == 1.0


@pytest.mark.serial
def test_supports_leave_motions_to_springs(comm):
    """Of a motion of 2 a pair whose spring holds resists all, one that slips or sticks nothing."""
    made, friction, sliding = friction_on(comm)
    motions = np.zeros((1, made.layout.size_local))
    motions[0, sliding.local[:, 0]] = [1.0, 2.0, 4.0]
    closed = np.ones(3, dtype=bool)
    assert friction.constraint_values(motions, closed).shape == (1, 0)
    chattering(made, friction, sliding, np.array([False, True, True]))
    imposed(friction, at(made, sliding, [0.0, 1e-9, 1e-6]), np.full(3, 10.0))
    np.testing.assert_allclose(friction.constraint_values(motions, closed), [[2.0, 0.0]])


@pytest.mark.ranks
def test_a_pair_that_begins_to_chatter_on_one_rank_is_a_change_on_all(comm, monkeypatch):
    """Its spring is another force, though it slipped before."""
    monkeypatch.setattr(PARTITION, along_x)
    made, friction, sliding = friction_on(comm)
    found = chattering(made, friction, sliding, at_right(made))
    said, stuck = zip(*found, strict=True)
    assert len(set(comm.allgather(said))) == 1
    last = said.index(False) - 1
    assert comm.allreduce(stuck[last] == stuck[last - 1], op=MPI.LAND)
    assert not any(said[last + 1 :])


def warped(points):
    """Return temperatures of an upper block that curve and twist it on its base [°C]."""
    x, y, z = (points / 0.02).T
    even = 0.4 * x * x + 1.7 * y * y + 1.1 * z * z + 0.7 * x * y + 0.7 * x * z - 0.9 * y * z
    return 20.0 + 30.0 * (-2.0 + 0.6 * x + 0.7 * y - 0.3 * z + even)


@pytest.mark.ranks
def test_friction_drives_nothing(comm):
    """A block that curves stands on few points, whose friction takes work and gives none.

    Pairs that chattered bore friction in a direction that their motion had left, 0.045 J.
    """
    metal = body(elastic(7e10, 0.33, 2e-5), body_force=(0.0, 0.0, -1e6))
    base = body(elastic(7e10, 0.3, 1e-5), formulation="displacement")
    made = problem(
        blocks(comm, "3d", (0.02, 0.02), (0.03, 0.02), size=0.01, symmetry=False),
        {"upper": metal, "base": base}, {"base": [fixed("bottom", "all")]},
        [Contact("upper", "base", friction=0.27)],
    )  # fmt: skip
    made.equilibrium.solve(0.0)
    made.equilibrium.present.commit()
    before = slid(comm, made)
    heat(made, warped)
    made.equilibrium.solve(0.0)
    along = made.contact_states()[0].force - normal_forces(made)[:, None] * made.pairs[0].normals
    work = everywhere(comm, np.sum(along * (slid(comm, made) - before), axis=1))
    assert work.max() < 1e-9 and np.linalg.norm(everywhere(comm, along), axis=1).max() > 0.1


def slid(comm, made):
    """Return the displacements of the pairs of this rank, of the upper beside the lower block."""
    found = {}
    for name in ("upper", "base"):
        nodes = everywhere(comm, places(made, name))
        at = [np.linalg.norm(nodes - point, axis=1).argmin() for point in made.pairs[0].points]
        found[name] = everywhere(comm, motion(made, name))[at, :3]
    return found["upper"] - found["base"]


def at_right(made):
    """Return whether pairs are the one at the right end, which belongs to the last rank."""
    return made.pairs[0].points[made.gaps.interfaces[0].index, 0] > 0.005
