"""The matrix of pairs that slip against dense sums of rows."""

from __future__ import annotations

import numpy as np
import pytest

from castx.arrays import BoolArray
from castx.contact.choice import Contact
from castx.contact.friction.condensed_slip import SlipState, matrix_with_slip
from castx.contact.friction.coulomb import SlidingRows, shortened
from tests.elastic_bodies import blocks, body, elastic, everywhere, fixed, problem
from tests.partitions import PARTITION, along_x
from tests.small_contact import SOFT, dense, two_blocks


def slipping(slips, force, along, moved):
    """Return rows of which none chatters."""
    return SlipState(slips, force, along, moved, np.zeros_like(slips), along, 0.0)


@pytest.mark.ranks
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_rows_that_slip_bear_the_row_of_the_gap(comm, monkeypatch, side):
    """r_t + μ d r_n in the rows of pairs that slip under pressure, all others as they were.

    The pair at one side does, that in the middle slips without pressure, the third one sticks.
    """
    monkeypatch.setattr(PARTITION, along_x)
    made = two_blocks(comm, friction=0.3)
    balance, layout = made.equilibrium.balance, made.layout
    normal = balance.contact.normal.matrix(balance.present(made.equilibrium.x))
    sliding = SlidingRows(made.gaps, [0.3])
    x = side * made.pairs[0].points[made.gaps.interfaces[0].index[sliding.rows], 0]
    along, force = np.where(x > 0.0, side, -side)[:, None], np.where(np.abs(x) > 0.005, 5e-6, 0.0)
    state = slipping(x > -0.005, force, along, np.zeros((len(x), 1)))
    turning = np.ones(len(x), dtype=bool)
    found = matrix_with_slip(normal, layout, made.gaps, sliding, state, turning, 1e9)
    expected, here = dense(comm, normal), x > 0.005
    [row] = everywhere(comm, layout.first + sliding.local[here, 0])
    [gap] = everywhere(comm, layout.first + made.gaps.local[sliding.rows[here]])
    expected[row] += 0.3 * side * expected[gap]
    np.testing.assert_allclose(dense(comm, found), expected, atol=1e-12 * np.abs(expected).max())


@pytest.mark.ranks
def test_friction_turns_with_the_motion_in_space(comm, monkeypatch):
    """The derivative of f m/|m| over the motion m is f (1 - d dᵀ)/|m|, at most as steep as told."""
    monkeypatch.setattr(PARTITION, along_x)
    made = problem(
        blocks(comm, "3d", symmetry=False, size=0.02),
        {n: body(elastic(*SOFT), formulation="displacement") for n in ("upper", "base")},
        {"base": [fixed("bottom", "all")]}, [Contact("upper", "base", friction=0.3)],
    )  # fmt: skip
    made.equilibrium.solve(0.0)
    balance, layout = made.equilibrium.balance, made.layout
    normal = balance.contact.normal.matrix(balance.present(made.equilibrium.x))
    sliding = SlidingRows(made.gaps, [0.3])
    count = len(sliding.rows)
    moved = 1e-6 * np.stack((np.cos(np.arange(count)), np.sin(np.arange(count))), axis=1)
    moved[:1] *= 1e-6
    along = moved / np.linalg.norm(moved, axis=1, keepdims=True)
    slips, force = np.ones(count, dtype=bool), np.full(count, 2.0)
    turning = slips.copy()
    turning[1:][-1:] = False
    state = slipping(slips, force, along, moved)
    still = slipping(slips, force, along, np.zeros_like(moved))
    both = [
        dense(comm, matrix_with_slip(normal, layout, made.gaps, sliding, s, turning, 1e9))
        for s in (state, still)
    ]
    added = both[0] - both[1]
    step = 1e-10
    for i in range(count):
        m, rows = moved[i], layout.first + sliding.local[i]
        if i == 0:
            expected = 1e9 * (np.eye(2) - np.outer(along[0], along[0]))
        elif i == count - 1:
            expected = np.zeros((2, 2))
        else:
            expected = np.array([
                2.0 * (_unit(m + step * e) - _unit(m - step * e)) / (2 * step) for e in np.eye(2)
            ]).T  # fmt: skip
        np.testing.assert_allclose(added[np.ix_(rows, rows)], expected, rtol=1e-5, atol=10.0)


def _unit(vector):
    return vector / np.linalg.norm(vector)


MOVED = np.array([[3e-9, 4e-9], [3e-9, 4e-9], [0.0, 0.0]])
CARRIED = np.array([[0.6, 0.8], [0.0, 0.5], [0.6, 0.8]])


def held(force, springs=1e8):
    """Return rows that chatter; the springs bear 0.5 N in the first two of them."""
    chatters, along = np.ones(3, dtype=bool), np.zeros((3, 2))
    along[:2] = [0.6, 0.8]
    return SlipState(chatters, np.array(force), along, MOVED, chatters, CARRIED, springs)


@pytest.mark.serial
def test_springs_hold_as_long_as_they_bear_less_than_friction_can():
    np.testing.assert_array_equal(held([0.6, 0.4, 0.0]).holds, [True, False, False])
    np.testing.assert_array_equal(held([0.6, 0.6, 0.1]).without_slip().holds, [False] * 3)


@pytest.mark.serial
def test_derivative_of_springs_and_of_what_slips_beyond_them():
    """While a spring holds c 1, beyond f/|m| (1 - w dᵀ), also where no direction follows."""
    found = held([0.6, 0.4, 0.1]).turning(np.zeros(3, dtype=bool), 1e12)
    beyond = 0.4 / 5e-9 * np.array([[1.0, 0.0], [-0.3, 0.6]])
    np.testing.assert_allclose(found, [1e8 * np.eye(2), beyond, 1e8 * np.eye(2)], rtol=1e-12)
    at_once = held([0.4, 0.4, 0.0]).turning(np.zeros(3, dtype=bool), 1e12)
    across = 0.4 / 5e-9 * np.array([[0.64, -0.48], [-0.48, 0.36]])
    np.testing.assert_allclose(at_once[0], across, rtol=1e-12)
    assert np.all(at_once[2] == 0.0)


@pytest.mark.serial
def test_springs_in_balance_against_differences():
    """Of the force min(c|m|, f) m/|m| over the motion m, on both sides of its limit."""
    force, c, step = np.array([0.6, 0.4, 0.2]), 1e8, 1e-14
    moved = np.array([[3e-9, 4e-9], [3e-9, -4e-9], [-5e-9, 1e-9]])

    def borne(motions):
        return force[:, None] * shortened(c * motions, force)

    some, along = np.ones(3, dtype=bool), shortened(c * moved, force)
    found = SlipState(some, force, along, moved, some, along, c).turning(~some, 1e12)
    for k, e in enumerate(step * np.eye(2)):
        difference = (borne(moved + e) - borne(moved - e)) / (2 * step)
        np.testing.assert_allclose(found[:, :, k], difference, rtol=1e-5, atol=1.0)


@pytest.mark.serial
def test_springs_that_hold_resist_all_motions_and_others_those_across():
    motions = np.array([[[1.0, 0.0]] * 3, [[0.0, 2.0]] * 3])
    found = held([0.6, 0.4, 0.0]).resisted(motions)
    expected = [[1.0, 0.0, 0.64, -0.48], [0.0, 2.0, -0.96, 0.72]]
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    state = slipping(np.ones(3, dtype=bool), np.ones(3), CARRIED, MOVED)
    assert state.resisted(motions).shape == (2, 0)


@pytest.mark.ranks
def test_what_a_spring_holds_does_not_see_the_pressure(comm, monkeypatch):
    """The rows of its motion get c on the diagonal and nothing of the row of the gap."""
    monkeypatch.setattr(PARTITION, along_x)
    made = two_blocks(comm, friction=0.3)
    balance, layout = made.equilibrium.balance, made.layout
    normal = balance.contact.normal.matrix(balance.present(made.equilibrium.x))
    sliding = SlidingRows(made.gaps, [0.3])
    some: BoolArray = np.ones(len(sliding.rows), dtype=bool)
    along, moved = np.full((len(some), 1), 0.5), np.full((len(some), 1), 1e-9)
    state = SlipState(some, np.ones(len(some)), along, moved, some, along, 5e8)
    found = matrix_with_slip(normal, layout, made.gaps, sliding, state, ~some, 1e12)
    expected, whole = dense(comm, normal), dense(comm, found)
    rows = everywhere(comm, layout.first + sliding.local[:, 0])
    expected[rows, rows] += 5e8
    np.testing.assert_allclose(whole, expected, atol=1e-12 * np.abs(expected).max())
