"""The matrix of pairs that slip against dense sums of rows."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.contact.friction.condensed_slip import SlipState, matrix_with_slip
from castx.contact.friction.coulomb import SlidingRows
from tests.elastic_bodies import blocks, body, elastic, everywhere, fixed, problem
from tests.partitions import PARTITION, along_x
from tests.small_contact import SOFT, dense, two_blocks


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
    state = SlipState(x > -0.005, force, along, np.zeros((len(x), 1)))
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
    state = SlipState(slips, force, along, moved)
    still = SlipState(slips, force, along, np.zeros_like(moved))
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
