"""Augmented Lagrangian multipliers by hand: what they take over, and when."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.augmented import AugmentedMultipliers
from tests.partitions import PARTITION, along_x
from tests.small_contact import two_blocks


def made(comm, every_iteration=False, most=2):
    gaps = two_blocks(comm, "augmented-lagrangian", solved=False).gaps
    return AugmentedMultipliers(comm, gaps, every_iteration, most), gaps


@pytest.mark.serial
def test_closed_pairs_take_over_what_they_carry(comm):
    multipliers, gaps = made(comm)
    wanted = np.array([3e5, -2e5, 4e5])
    closed = np.array([True, True, False])
    assert multipliers.augment(wanted * gaps.areas, closed, balanced=True, enough=0.0)
    np.testing.assert_allclose(multipliers.pressures, [3e5, 0.0, 0.0])
    np.testing.assert_allclose(multipliers.forces(), [3e5 * gaps.areas[0], 0.0, 0.0])
    assert multipliers.updates == 1


@pytest.mark.serial
def test_a_change_that_is_not_worth_it_ends_the_loop(comm):
    multipliers, gaps = made(comm)
    forces, closed = 1e5 * gaps.areas, np.ones(3, dtype=bool)
    assert not multipliers.augment(forces, closed, True, 1.01 * np.linalg.norm(forces))
    assert multipliers.augment(forces, closed, True, 0.99 * np.linalg.norm(forces))
    assert not multipliers.augment(forces, closed, True, 0.0)


@pytest.mark.serial
@pytest.mark.parametrize("every_iteration", [False, True])
def test_when_it_updates(comm, every_iteration):
    multipliers, gaps = made(comm, every_iteration)
    closed = np.ones(3, dtype=bool)
    forces = 1e5 * gaps.areas
    assert multipliers.augment(forces, closed, balanced=False, enough=0.0) == every_iteration


@pytest.mark.serial
def test_at_most_so_many_updates_in_a_solve(comm):
    multipliers, gaps = made(comm, most=2)
    closed = np.ones(3, dtype=bool)
    changed = [
        multipliers.augment(p * gaps.areas, closed, balanced=True, enough=0.0)
        for p in (1e5, 2e5, 3e5)
    ]
    assert changed == [True, True, False]
    multipliers.begin()
    assert multipliers.augment(4e5 * gaps.areas, closed, balanced=True, enough=0.0)


@pytest.mark.serial
def test_memory(comm):
    multipliers, gaps = made(comm)
    x = gaps.matrix.createVecRight()
    closed = np.ones(3, dtype=bool)
    multipliers.augment(1e5 * gaps.areas, closed, True, 0.0)
    multipliers.commit(x)
    multipliers.augment(9e5 * gaps.areas, closed, True, 0.0)
    multipliers.rewind(x)
    np.testing.assert_allclose(multipliers.pressures, 1e5)
    other, _ = made(comm)
    other.restore(multipliers.saved())
    np.testing.assert_allclose(other.pressures, 1e5)


@pytest.mark.serial
def test_pairs_that_a_liquid_holds_may_pull(comm):
    multipliers, gaps = made(comm)
    multipliers.may_pull = np.array([False, True, True])
    closed = np.array([True, True, False])
    multipliers.augment(np.array([-3e5, -2e5, -4e5]) * gaps.areas, closed, True, 0.0)
    np.testing.assert_allclose(multipliers.pressures, [0.0, -2e5, 0.0])


@pytest.mark.ranks
def test_pressures_that_change_on_one_rank_are_an_update_on_all(comm, monkeypatch):
    monkeypatch.setattr(PARTITION, along_x)
    multipliers, gaps = made(comm)
    right = gaps.interfaces[0].pairs.points[gaps.interfaces[0].index, 0] > 0.005
    forces = np.where(right, 3e5, 0.0) * gaps.areas
    assert multipliers.augment(forces, np.ones(len(right), dtype=bool), True, 0.0)
    assert multipliers.updates == 1
