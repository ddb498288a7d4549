"""Time left of courses whose end is known: freezing by equal shares, growing steps, cycles."""

import numpy as np
import pytest

from castx.process.remaining import LARGEST_GROWTH, Remaining
from castx.results.states.snapshot import ProcessState
from castx.solvers.counters import StepCounters
from tests.castx.fakes import FakeSnapshot

pytestmark = pytest.mark.serial

COLUMN = "casting.solid_fraction"


def follow(end, sizes, solids, largest=np.inf, cycle=1):
    """Return the time left after each step of 2 s on the wall clock."""
    remaining, left, time = Remaining(end, largest), [], 0.0
    for size, solid in zip(sizes, solids, strict=True):
        time += size
        snapshot = FakeSnapshot(
            time, 1, None, totals={COLUMN: solid}, counters=StepCounters(step=size, wall=2.0),
            process=ProcessState(cycle=cycle),
        )  # fmt: skip
        remaining.note(snapshot, COLUMN)
        left.append(remaining.wall())
    return left


def test_a_casting_that_freezes_in_equal_shares_and_cools_in_growing_steps():
    """40 steps of 0.01 to 0.1 s, then 30 that grow: from step 10 on within a factor of two."""
    growing = 0.01 * LARGEST_GROWTH ** np.arange(6)
    sizes = np.concatenate([growing, np.full(34, 0.1), 0.1 * 1.2 ** np.arange(1, 31)])
    solids = np.concatenate([np.full(6, 0.001), np.linspace(0.03, 1.0, 34), np.ones(30)])
    left = follow(sizes.sum(), sizes, solids, largest=sizes.max())
    assert left[:6] == [None] * 6, "nothing is known before it freezes"
    for step in range(9, 69):
        true = 2.0 * (len(sizes) - step - 1)
        assert 0.5 * true - 4.0 < left[step] < 3.0 * true + 4.0
    pace = 0.01 * LARGEST_GROWTH**5 * 6  # of the first steps: many hours by their pace
    assert left[9] < 0.5 * 2.0 * sizes.sum() / pace * 6


def test_a_run_that_ends_before_all_is_solid_takes_no_more_steps_than_to_its_end():
    left = follow(1.0, [0.1] * 10, np.linspace(0.03, 0.3, 10))
    assert left[1:] == [2.0 * steps for steps in range(8, -1, -1)]


def test_steps_grow_no_larger_than_the_largest():
    sizes = [1.0, 1.5, 2.25, 3.375]
    left = follow(200.0, sizes, [1.0] * 4, largest=4.0)
    assert left[-1] == 2.0 * np.ceil((200.0 - sum(sizes)) / 4.0)


def test_steps_that_a_stage_has_made_small_grow_again():
    sizes = [10.0, 12.0, 14.0, 0.1, 0.15, 0.225]
    rest, steps, size = 100.0, 0, sizes[-1]
    while rest > 0.0:
        size, steps = min(1.5 * size, 14.0), steps + 1
        rest -= size
    left = follow(sum(sizes) + 100.0, sizes, [1.0] * 6, largest=14.0)
    assert left[-1] == pytest.approx(2.0 * steps)
    assert left[-2] < 2.0 * left[-1]


def test_cycles_take_as_long_as_those_before():
    left = follow(100.0, [1.0, 4.0, 5.0], [0.5, 1.0, 0.1], cycle=2)
    assert left[-1] == pytest.approx(6.0 / 10.0 * 90.0)


def test_a_casting_that_melts_again_says_nothing():
    assert follow(10.0, [1.0, 1.0, 1.0], [0.5, 0.4, 0.3])[-1] is None
