"""The active set alone: pairs given by formulas, distributed over all ranks."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.kinematics.active_set import PROVISIONAL, ActiveSet, Pivoting
from tests.elastic_bodies import everywhere


class Complementarity:
    """The problem λ ≥ 0, g = M λ + q ≥ 0, λ g = 0, of which every rank holds some rows."""

    def __init__(self, comm, M, q, closed):
        self.comm, self.M, self.q = comm, np.array(M, dtype=float), np.array(q, dtype=float)
        self.mine = np.arange(len(q))[comm.rank :: comm.size]
        initial = np.where(closed, 0.0, 1.0)[self.mine]
        keys = np.abs(np.sin(1.0 + self.mine))
        self.active = ActiveSet(comm, initial, np.ones(len(self.mine), dtype=bool), keys)

    def solution(self):
        """Return forces and gaps of all pairs for the present set."""
        closed = np.zeros(len(self.q), dtype=bool)
        closed[everywhere(self.comm, self.mine[self.active.closed])] = True
        force = np.zeros(len(self.q))
        force[closed] = np.linalg.solve(self.M[np.ix_(closed, closed)], -self.q[closed])
        return force, self.M @ force + self.q

    def step(self):
        force, gap = self.solution()
        trial = np.where(self.active.closed, force[self.mine], -gap[self.mine])
        return self.active.update(trial)

    def solve(self, most):
        for count in range(most):
            if not self.step():
                return count
        raise AssertionError(f"still changes after {most} steps")


def chain(n: int) -> np.ndarray:
    """Return an M-matrix, for which the iteration is monotone."""
    return 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)


@pytest.mark.parametrize("start", ["all closed", "all open"])
def test_finds_the_closed_pairs(comm, start):
    n = 20
    load = np.cos(0.7 * np.arange(n)) + 0.3
    problem = Complementarity(comm, chain(n), load, np.full(n, start == "all closed"))
    problem.solve(n + 1)
    force, gap = problem.solution()
    assert force.min() >= 0.0
    assert gap.min() >= -1e-14
    assert np.abs(force * gap).max() < 1e-12
    assert 0 < np.count_nonzero(force) < n
    assert not problem.active.cycles
    assert problem.active.changes > 0


@pytest.mark.ranks
def test_ends_where_the_plain_iteration_goes_round(comm):
    """I. Ben Gharbia and J. C. Gilbert (2012), Math. Program. 134: a P-matrix with a cycle of 3."""
    t = 2.0
    M = [[1, 0, t], [t, 1, 0], [0, t, 1]]
    problem = Complementarity(comm, M, [-1.0, -1.0, -1.0], [True, False, False])
    problem.solve(20)
    assert problem.active.cycles
    np.testing.assert_allclose(problem.solution()[0], 1 / (1 + t))
    problem.active.begin()
    assert not problem.active.cycles
    assert problem.active.changes == 0


def test_pairs_without_a_constraint_never_close(comm):
    n = 4
    free = np.arange(n) % 2 == 0
    active = ActiveSet(comm, np.full(n, -1.0), free, np.linspace(0.1, 0.9, n))
    np.testing.assert_array_equal(active.closed, free)
    active.update(np.full(n, 1.0))
    np.testing.assert_array_equal(active.closed, free)


def test_noise_beside_the_largest_force_changes_nothing(comm):
    active = ActiveSet(comm, np.array([0.0, 0.0, 1.0]), np.ones(3, dtype=bool), np.ones(3) / 3)
    assert not active.update(np.array([1e9, -1e-5, 1e-5]))
    assert not active.update(np.array([1e9, -1.0, 1e-5]), 2.0)
    above = ActiveSet(comm, np.array([0.0, 0.0, 1.0]), np.ones(3, dtype=bool), np.ones(3) / 3)
    assert above.update(np.array([1e9, -2.1, 1e-5]), 2.0)
    assert active.update(np.array([1e9, -1.0, 1e-5]))
    small = ActiveSet(comm, np.zeros(2), np.ones(2, dtype=bool), np.ones(2) / 2)
    assert not small.update(np.array([1e-9, -0.9e-21]))
    assert small.update(np.array([1e-9, -1.1e-21]))


@pytest.mark.ranks
def test_noise_beside_the_largest_force_of_any_rank_changes_nothing(comm):
    here = slice(0, 1) if comm.rank == comm.size - 1 else slice(1, 3)
    count = len(np.arange(3)[here])
    active = ActiveSet(
        comm, np.array([0.0, 0.0, 1.0])[here], np.ones(count, dtype=bool), np.ones(count) / 3
    )
    assert not active.update(np.array([1e9, -1e-5, 1e-5])[here])


@pytest.mark.ranks
def test_a_pull_on_one_rank_is_that_of_all(comm):
    """The last rank alone has a pair."""
    forces = np.full(1 if comm.rank == comm.size - 1 else 0, -3.0)
    active = ActiveSet(comm, np.zeros_like(forces), forces < 0.0, np.ones_like(forces))
    assert active.largest_pull(forces) == 3.0
    assert active.violates(forces, 1.0) and not active.violates(forces, 4.0)


@pytest.mark.ranks
def test_once_a_set_returns_the_worst_pair_of_all_ranks_changes_alone(comm):
    violation = np.array([1.0 + comm.rank])
    pivoting = Pivoting(comm, np.array([0.1 + 0.01 * comm.rank]))
    closed = np.zeros(1, dtype=bool)
    pivoting.begin(closed)
    assert pivoting.next(closed, violation).all()
    changed = pivoting.next(~closed, violation)
    assert pivoting.one_by_one
    assert changed.tolist() == [comm.rank == comm.size - 1]


@pytest.mark.ranks
@pytest.mark.parametrize(("apart", "together"), [(1e-4, True), (1e-2, False)])
def test_pairs_that_are_as_bad_as_the_worst_one_change_with_it(comm, apart, together):
    """A casting that mirrors itself keeps to sets that do so too."""
    violation = np.array([1.0 - apart * comm.rank, 1.0 - apart, 0.5])
    pivoting = Pivoting(comm, np.array([0.1, 0.2, 0.3]) + 0.01 * comm.rank)
    closed = np.zeros(3, dtype=bool)
    pivoting.begin(closed)
    pivoting.next(closed, violation)
    changed = pivoting.next(~closed, violation)
    assert changed.tolist() == [comm.rank == 0 or together, together, False]


def test_rewind_returns_to_the_committed_set(comm):
    active = ActiveSet(comm, np.array([0.0, 1.0]), np.ones(2, dtype=bool), np.array([0.2, 0.7]))
    active.update(np.array([-1.0, 1.0]))
    np.testing.assert_array_equal(active.closed, [False, True])
    active.rewind()
    np.testing.assert_array_equal(active.closed, [True, False])
    active.begin()
    active.update(np.array([-1.0, 1.0]))
    active.commit()
    active.rewind()
    np.testing.assert_array_equal(active.closed, [False, True])


@pytest.mark.ranks
def test_a_pair_that_opens_on_one_rank_is_a_change_on_all(comm):
    last = comm.rank == comm.size - 1
    active = ActiveSet(comm, np.zeros(1), np.ones(1, dtype=bool), np.array([0.1 + comm.rank / 10]))
    assert active.update(np.array([-1.0 if last else 1.0]))
    assert active.changes == 1
    assert active.closed[0] == (not last)


@pytest.mark.ranks
def test_a_pair_without_force_that_chatters_is_frozen_where_it_violates_less(comm):
    """Noise pulls a pair that alone holds a body: opened, the body falls and others close."""
    here = slice(0, 2 if comm.rank == comm.size - 1 else 0)
    active = ActiveSet(
        comm, np.array([0.0, 1.0])[here], np.ones(2, dtype=bool)[here], np.array([0.3, 0.6])[here]
    )
    for _ in range(6):
        first, second = everywhere(comm, active.closed)
        forces = np.array([-1e-6 if first and not second else 10.0, -1.0 if second else 0.0])
        if not active.update(forces[here]):
            break
    else:
        raise AssertionError("still changes")
    np.testing.assert_array_equal(everywhere(comm, active.closed), [True, False])
    np.testing.assert_array_equal(everywhere(comm, active.frozen), [True, False])
    active.begin()
    assert active.frozen_pairs() == 1
    active.commit()
    assert active.frozen_pairs() == 0


def test_a_set_that_returns_before_the_forces_settle_is_no_cycle(comm):
    """The problem has moved: what was pulled by an out-of-balance force closes again for good."""
    active = ActiveSet(comm, np.zeros(2), np.ones(2, dtype=bool), np.array([0.3, 0.6]))
    assert active.update(np.array([-1610.0, 5.0]), settled=False)
    np.testing.assert_array_equal(active.closed, [False, True])
    assert active.update(np.array([2.0, 5.0]), settled=False)
    assert not active.update(np.array([3.0, 5.0]))
    np.testing.assert_array_equal(active.closed, [True, True])
    assert not active.cycles and active.frozen_pairs() == 0


@pytest.mark.ranks
def test_nothing_changes_before_the_forces_settle_once_a_set_has_returned(comm):
    active = ActiveSet(comm, np.zeros(1), np.ones(1, dtype=bool), np.array([0.3 + comm.rank]))
    assert active.update(np.array([-1.0]))
    assert active.update(np.array([1.0]))
    assert active.cycles
    assert not active.update(np.array([-1.0]), settled=False)
    assert active.update(np.array([-1.0]))


@pytest.mark.parametrize("seed", range(12))
def test_ends_at_the_solution_of_every_p_matrix(comm, seed):
    """Mostly skew matrices, for which sets return all the time: one pair alone must not freeze."""
    dice = np.random.default_rng(seed)
    n = 8
    root, skew = dice.normal(size=(2, n, n))
    M = 1e-3 * root @ root.T + 10.0 * (skew - skew.T)
    problem = Complementarity(comm, M, 2.0 * dice.normal(size=n) - 1.0, dice.random(n) < 0.5)
    problem.solve(300)
    force, gap = problem.solution()
    assert force.min() >= -1e-9 * np.abs(force).max()
    assert gap.min() >= -1e-9 * np.abs(M @ force).max()
    assert problem.active.frozen_pairs() == 0


def test_a_pair_that_violates_its_state_is_seen_frozen_or_not(comm):
    here = slice(0, 2 if comm.rank == 0 else 0)
    active = ActiveSet(
        comm, np.array([0.0, 1.0])[here], np.ones(2, dtype=bool)[here], np.array([0.3, 0.6])[here]
    )
    for _ in range(2):
        assert active.violates(np.array([-5.0, 0.0])[here], 1.0)
        assert active.violates(np.array([5.0, 5.0])[here], 1.0)
        assert not active.violates(np.array([-5.0, 5.0])[here], 6.0)
        assert not active.violates(np.array([5.0, -5.0])[here], 1.0)
        assert active.largest_pull(np.array([-5.0, -9.0])[here]) == (
            0.0 if active.frozen_pairs() else 5.0
        )
        assert active.largest_pull(np.array([-5.0, -9.0])[here], with_frozen=True) == 5.0
        active.frozen[:1] = True


def test_pairs_without_force_are_released_once_in_a_step(comm):
    here = slice(0, 3 if comm.rank == comm.size - 1 else 0)
    active = ActiveSet(
        comm, np.zeros(3)[here], np.ones(3, dtype=bool)[here], np.array([0.2, 0.4, 0.6])[here]
    )
    forces = np.array([5.0, 1e-9, -1e-9])[here]
    released = active.release(forces, 1e-6)
    np.testing.assert_array_equal(everywhere(comm, released), [False, True, True])
    np.testing.assert_array_equal(everywhere(comm, active.closed), [True, False, False])
    active.close(released)
    assert everywhere(comm, active.closed).all()
    assert not everywhere(comm, active.release(forces, 1e-6)).any()
    active.commit()
    assert everywhere(comm, active.release(forces, 1e-6)).sum() == 2


def test_cycles_are_found_again_after_twenty_changes_of_friction(comm):
    """Else friction and contact could drive each other round for ever."""
    active = ActiveSet(comm, np.zeros(1), np.ones(1, dtype=bool), np.array([0.1 + comm.rank / 10]))
    for _ in range(20):
        assert active.update(np.where(active.closed, -1.0, 1.0))
        active.restart_cycle_detection()
        assert not active.cycles
    for _ in range(2):
        active.update(np.where(active.closed, -1.0, 1.0))
        active.restart_cycle_detection()
    assert active.cycles


def test_held_pairs_bear_pulls_up_to_their_limit_and_let_go_once(comm):
    """Of four closed pairs one bears its pull; another lets go, and is free until the next step."""
    here = slice(0, 4 if comm.rank == 0 else 0)
    keys, free = np.array([0.2, 0.3, 0.5, 0.7])[here], np.ones(4, dtype=bool)[here]
    active = ActiveSet(comm, np.zeros(4)[here], free, keys)
    limits, none = np.array([4.0, 0.0, 4.0, 4.0])[here], np.zeros(4, dtype=bool)[here]
    for _ in range(PROVISIONAL - 1):
        active.hold(limits, none)
    pull = np.array([-3.9, -3.0, -9.0, 2.0])[here]
    active.hold(limits, none)
    np.testing.assert_array_equal(active.held, np.array([True, False, True, True])[here])
    assert active.largest_pull(pull) == 5.0
    assert active.violates(pull, 1e-6)
    assert active.update(pull)
    np.testing.assert_array_equal(active.closed, np.array([True, False, False, True])[here])
    np.testing.assert_array_equal(active.held, np.array([True, False, False, True])[here])
    assert not active.update(np.array([-3.9, -1.0, -1.0, 2.0])[here])
    # What has let go closes by its own force, and cannot be pulled again in this step.
    active.update(np.array([-3.9, -1.0, 1.0, 2.0])[here])
    active.hold(limits, none)
    active.begin()
    assert active.update(np.array([-3.9, -1.0, -1.0, 2.0])[here])
    np.testing.assert_array_equal(active.closed, np.array([True, False, False, True])[here])
    active.commit()
    active.hold(limits, none)
    np.testing.assert_array_equal(active.held, np.array([True, False, False, True])[here])


@pytest.mark.ranks
@pytest.mark.parametrize("liquid", [False, True])
def test_what_lets_go_is_held_anew_by_the_second_pass_if_it_is_liquid_then(comm, liquid):
    """One pair of each rank: it freezes, lets go, melts or bears more, freezes, melts again."""
    active = ActiveSet(comm, np.zeros(1), np.ones(1, dtype=bool), np.array([0.1 + comm.rank / 10]))
    none, molten = np.zeros(1, dtype=bool), np.inf if liquid else 9.1
    for step in range(2):
        for count, bears in enumerate((4.0, molten, 4.0, molten)):
            active.hold(np.array([bears]), none)
            active.begin()
            again = liquid and count in (1, 2)
            assert active.closed.all() == (count == 0 or again)
            active.update(np.where(active.closed, -9.0, -1.0))
            assert active.closed.all() == (again and count == 1)
        active.rewind() if step == 0 else active.commit()
    active.hold(np.array([molten]), none)
    assert not active.closed.any(), "open when the step began"


def test_a_pair_closes_where_its_metal_is_liquid(comm):
    """Open ones are held only there: a skin that has left its wall is free."""
    active = ActiveSet(comm, np.ones(3), np.ones(3, dtype=bool), np.array([0.2, 0.5, 0.7]))
    active.hold(np.full(3, 4.0), np.array([True, False, False]))
    np.testing.assert_array_equal(active.closed, [True, False, False])
    np.testing.assert_array_equal(active.held, [True, False, False])


def test_rewind_lets_go_of_held_pairs(comm):
    active = ActiveSet(comm, np.ones(2), np.ones(2, dtype=bool), np.array([0.2, 0.7]))
    limits, liquid = np.array([4.0, 0.0]), np.array([True, False])
    active.hold(limits, liquid)
    active.rewind()
    assert not active.closed.any() and not active.held.any()
    active.hold(limits, liquid)
    active.commit()
    np.testing.assert_array_equal(active.committed, [True, False])
